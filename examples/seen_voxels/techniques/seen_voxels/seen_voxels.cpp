// The voxels that the camera sees, in a port kind of their own: one pass fills it and one reads it.
#include "seen_voxels.h"

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/grid_placement.h"
#include "seen_voxels_shaders.h"

namespace lumivox::seen_voxels {
namespace {

namespace code = shaders::seen_voxels;

class MarkPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  Param<int> resolution{this, "resolution", 32, within(8, kLargestGrid),
                        "voxels along the scene's longest side"};
  Out<SeenVoxels> voxels{this, "voxels", "voxels in which a pixel sees a surface"};

  Reads readsFrom() const override { return Reads::geometry; }

  void run(PassContext& frame) override {
    const GridPlacement grid = placeGrid(frame.snapshot().gridBounds, resolution);
    const SeenVoxels result{grid, frame.volume(grid.resolution, gpu::Format::r8, "seen voxels")};
    result.seen->clear(glm::vec4(0.0f));
    frame.dispatch(frame.program(code::mark::kProgram),
                   {GBufferBinding(*gbuffer), code::mark::seenImage(result.seen),
                    code::mark::grid({.gridLow = grid.low, .voxelSize = grid.voxelSize})},
                   pixels(frame));
    voxels = result;
  }
};

class ShowPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<SeenVoxels> voxels{this, "voxels", "voxels that are looked up at the surfaces"};
  Out<Image> shown{this, "shown", "1 where the surface lies in one of the voxels, else 0"};

  void run(PassContext& frame) override {
    const Image result{frame.image("surfaces in seen voxels")};
    frame.dispatch(frame.program(code::show::kProgram),
                   {GBufferBinding(*gbuffer), code::show::seen(voxels->seen, gpu::Sampling::nearest),
                    code::show::shownImage(result.texture),
                    code::show::grid({.gridLow = voxels->grid.low, .voxelSize = voxels->grid.voxelSize})},
                   pixels(frame));
    shown = result;
  }
};

}  // namespace
}  // namespace lumivox::seen_voxels

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::seen_voxels;
  registry.describe("Voxels that the camera sees", "an example of a kind of port of one's own");
  registry.add<MarkPass>("mark", "Voxels in which a pixel sees a surface");
  registry.add<ShowPass>("show", "Pixels whose surface lies in such a voxel");
}
