// Voxels from a texture atlas of the surface (Thiedemann et al. 2011): bits (binary voxelization) or
// fragments (multi-valued voxelization).
#include "lumivox/scene/atlas.h"

#include <glm/gtc/packing.hpp>

#include "bit_voxelizer.h"
#include "lumivox/base/log.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

/// The atlas on the device, as a part of a pass: the texels that lie on the surface. They are made in the
/// first frame and again only when their size changes, and are never read back.
class AtlasTexels {
 public:
  explicit AtlasTexels(Pass* pass)
      : texelsPerVoxel_(pass, "texels_per_voxel", 2.0f, within(0.1f, 16.0f),
                        "texels of the atlas along the side of a voxel; fewer leave holes") {}

  /// Runs an invocation for each texel of each of these draws.
  template <class Draws, class Variant>
  void dispatch(PassContext& frame, const GridPlacement& grid, const Draws& draws, const Variant& variant,
                const shader::BindingSet& bindings) {
    update(frame, static_cast<double>(grid.voxelSize) / static_cast<double>(texelsPerVoxel_));
    for (const SceneDraw* draw : draws) {
      // Draws are the parts of all objects in their order.
      const AtlasPart& texels = parts_.at(static_cast<std::size_t>(draw - frame.scene().draws().data()));
      const SceneBinding scene(frame, *draw);
      frame.dispatchList(frame.program(scene.in(variant)),
                         {scene, bindings, shader::StorageSlot{"TexelTriangles"}(triangles_),
                          shader::StorageSlot{"TexelPlaces"}(places_),
                          shader::UniformSlot<Texels>{"Texels"}(
                              {static_cast<int>(texels.firstTexel), static_cast<int>(texels.texelCount)})},
                         texels.texelCount);
    }
  }

 private:
  /// For texels of this size at rest, in metres.
  void update(PassContext& frame, double texelSize) {
    if (triangles_ != nullptr && texelSize == texelSize_) return;
    const SurfaceAtlas atlas = makeSurfaceAtlas(frame.sceneDescription(), texelSize);
    logDetails("atlas: {} texels of {:.3g} m in {} charts, in a square of {} texels a side",
               atlas.texels.size(), texelSize, atlas.chartCount, atlas.side);
    parts_ = atlas.parts;
    std::vector<std::uint32_t> triangles, places;
    for (const AtlasTexel& texel : atlas.texels) {
      triangles.push_back(texel.triangle);
      places.push_back(glm::packUnorm2x16({texel.second, texel.third}));
    }
    triangles_ = frame.uploaded(triangles, "atlas texels: triangles");
    places_ = frame.uploaded(places, "atlas texels: places");
    texelSize_ = texelSize;
  }

  // With two, neighbours on the surface are at most 0.71 voxels apart.
  Param<float> texelsPerVoxel_;
  double texelSize_ = 0.0;
  std::vector<AtlasPart> parts_;
  gpu::BufferRef triangles_, places_;
};

class AtlasBinaryPass : public BitVoxelizer {
  AtlasTexels atlas_{this};
  Param<float> pointSize{
      this, "point_size", 1.0f, within(1.0f, 16.0f),
      "side of a texel's point across the stacks, in voxels; above 1 it closes holes of an atlas "
      "with too few texels, and thickens surfaces along the stacks"};

  void mark(PassContext& frame, const GridPlacement& grid, const gpu::Texture& words,
            const Draws& draws) override {
    atlas_.dispatch(frame, grid, draws, atlas_binary::Variant{},
                    {atlas_binary::words(words), gridBinding(grid), atlas_binary::point({pointSize})});
  }
};

class AtlasAttributesPass : public Voxelizer {
  AtlasTexels atlas_{this};

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    atlas_.dispatch(frame, list.grid, draws, atlas_attributes::Variant{}, appending(list));
  }
};

}  // namespace

void addAtlas(TechniqueRegistry& registry) {
  registry.add<AtlasBinaryPass>("atlas_binary",
                                "Bits from a texture atlas of the surface (Thiedemann et al. 2011)");
  registry.add<AtlasAttributesPass>("atlas_attributes",
                                    "Fragments from a texture atlas of the surface (Thiedemann et al. 2011)");
}

}  // namespace lumivox::voxelization
