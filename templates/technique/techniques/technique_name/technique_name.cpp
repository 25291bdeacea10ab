// Light of one radiance from all sides: the simplest indirect light, and a start for a technique of your own.
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "technique_name_shaders.h"

namespace lumivox::technique_name {
namespace {

namespace code = shaders::technique_name;

class GatherPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  Param<float> radiance{this, "radiance", 0.2f, within(0.0f, 1e6f),
                        "radiance that arrives from everywhere, W/(sr m^2)"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "light reflected by the diffuse lobe, W/(sr m^2)"};

  void run(PassContext& frame) override {
    const Image result{frame.image("diffusely reflected light")};
    frame.dispatch(frame.program(code::gather::kProgram),
                   {GBufferBinding(*gbuffer), code::gather::diffuseImage(result.texture),
                    code::gather::parameters({.radiance = radiance})},
                   pixels(frame));
    diffuse = result;
  }
};

}  // namespace
}  // namespace lumivox::technique_name

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::technique_name;
  registry.describe("Light of one radiance from all sides", "a start for a technique of your own");
  registry.add<GatherPass>("gather", "What surfaces reflect of light that arrives from everywhere");
}
