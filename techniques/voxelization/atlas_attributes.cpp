// Fragments from a texture atlas of the surface (multi-valued voxelization of Thiedemann et al. 2011).
#include "atlas_texels.h"
#include "voxelization_shaders.h"
#include "voxelizer.h"

namespace lumivox::voxelization {
namespace {

namespace code = shaders::voxelization::atlas_attributes;

class AtlasAttributesPass : public Voxelizer {
  Param<float> texelsPerVoxel{this, "texels_per_voxel",    kTexelsPerVoxel, kTexelsPerVoxelRange,
                              "",   kTexelsPerVoxelMeaning};

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    atlas_.update(frame, static_cast<double>(list.grid.voxelSize) / static_cast<double>(texelsPerVoxel));
    for (const SceneDraw* draw : draws) {
      const AtlasPart texels = atlas_.texelsOf(frame, *draw);
      const SceneBinding scene(frame, *draw);
      frame.dispatchList(frame.program(code::Variant{scene.textures, scene.masks}),
                         {scene, atlas_.bindings(texels), appending(list),
                          code::grid({list.grid.low, list.grid.voxelSize, list.grid.resolution,
                                      static_cast<int>(list.capacity)})},
                         texels.texelCount);
    }
  }

  AtlasTexels atlas_;
};

}  // namespace

void addAtlasAttributes(TechniqueRegistry& registry) {
  registry.add<AtlasAttributesPass>("atlas_attributes",
                                    "Fragments from a texture atlas of the surface (Thiedemann et al. 2011)");
}

}  // namespace lumivox::voxelization
