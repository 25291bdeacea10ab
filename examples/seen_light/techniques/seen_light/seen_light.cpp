// The light of a grid that visible surfaces reflect: a pass that reads one of the framework's port kinds.
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/sh_grid.h"
#include "seen_light_shaders.h"

namespace lumivox::seen_light {
namespace {

namespace code = shaders::seen_light;

class ShowPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<ShGrid> light{this, "light", "radiance that arrives in each voxel"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "light reflected by the diffuse lobe, W/(sr m^2)"};

  void run(PassContext& frame) override {
    const ShLight incoming =
        readShGrid(light, {.quantity = ShGrid::Quantity::radiance, .unit = ShReading::Unit::any});
    const ShGrid::Level& level = incoming.levels.back();  // the largest
    const Image result{frame.image("diffusely reflected light")};
    frame.dispatch(frame.program(code::show::kProgram),
                   {GBufferBinding(*gbuffer), ShLevelBinding(level, gpu::Sampling::linear),
                    code::show::diffuseImage(result.texture),
                    code::show::grid({.gridLow = level.grid.low,
                                      .voxelSize = level.grid.voxelSize,
                                      .resolution = level.grid.resolution,
                                      .unit = incoming.unit})},
                   pixels(frame));
    diffuse = result;
  }
};

}  // namespace
}  // namespace lumivox::seen_light

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::seen_light;
  registry.describe("Light of a grid at visible surfaces", "an example of a pass that reads voxels");
  registry.add<ShowPass>("show", "What visible surfaces reflect of the light in a grid");
}
