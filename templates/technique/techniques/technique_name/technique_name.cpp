// Light of one radiance from all sides: the simplest indirect light, and a start for a technique of your own.
#include "lumivox/plugin/technique.h"
#include "technique_name_shaders.h"

namespace lumivox::technique_name {
namespace {

namespace gatherShader = shaders::technique_name::gather;

class GatherPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  Param<float> radiance{this,         "radiance", 0.2f,
                        {0.0f, 1e6f}, "",         "radiance that arrives from everywhere, W/(sr m^2)"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "light reflected by the diffuse lobe, W/(sr m^2)"};

  void run(PassContext& frame) override {
    const Image result{frame.image(gpu::Format::rgba32f, "diffusely reflected light")};
    const CameraView& camera = frame.snapshot().camera;
    frame.dispatch(
        frame.program(gatherShader::kProgram),
        {gatherShader::gPosition(*gbuffer->position, gpu::Sampling::nearest),
         gatherShader::gDiffuse(*gbuffer->diffuse, gpu::Sampling::nearest),
         gatherShader::diffuseImage(*result.texture), gatherShader::parameters({.radiance = radiance})},
        {camera.width, camera.height, 1}, gatherShader::kGroupSize);
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
