// Bits from a texture atlas of the surface (binary voxelization of Thiedemann et al. 2011).
#include "atlas_texels.h"
#include "bit_voxelizer.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {
namespace {

namespace code = shaders::voxelization::atlas_binary;

class AtlasBinaryPass : public BitVoxelizer {
  Param<float> texelsPerVoxel{this, "texels_per_voxel",    kTexelsPerVoxel, kTexelsPerVoxelRange,
                              "",   kTexelsPerVoxelMeaning};

  Param<float> pointSize{
      this, "point_size", 1.0f, within(1.0f, 16.0f),
      "side of a texel's point across the stacks, in voxels; above 1 it closes holes of an atlas "
      "with too few texels, and thickens surfaces along the stacks"};

  void mark(PassContext& frame, const GridPlacement& grid, const gpu::Texture& words,
            const Draws& draws) override {
    atlas_.update(frame, static_cast<double>(grid.voxelSize) / static_cast<double>(texelsPerVoxel));
    for (const SceneDraw* draw : draws) {
      const AtlasPart texels = atlas_.texelsOf(frame, *draw);
      const SceneBinding scene(frame, *draw);
      frame.dispatchList(frame.program(code::Variant{scene.masks}),
                         {scene, atlas_.bindings(texels), code::words(words),
                          code::grid({grid.low, grid.voxelSize, grid.resolution, pointSize})},
                         texels.texelCount);
    }
  }

  AtlasTexels atlas_;
};

}  // namespace

void addAtlasBinary(TechniqueRegistry& registry) {
  registry.add<AtlasBinaryPass>("atlas_binary",
                                "Bits from a texture atlas of the surface (Thiedemann et al. 2011)");
}

}  // namespace lumivox::voxelization
