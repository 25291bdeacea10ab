// Bits from a texture atlas of the surface (binary voxelisation of Thiedemann et al. 2011).
#include "atlas_texels.h"
#include "bit_voxeliser.h"
#include "fragment_list.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {
namespace {

namespace binaryShader = shaders::voxelization::atlas_binary;

class AtlasBinaryPass : public BitVoxeliser {
  Param<float> texelsPerVoxel{this, "texels_per_voxel",    kTexelsPerVoxel, kTexelsPerVoxelRange,
                              "",   kTexelsPerVoxelMeaning};

  Param<float> pointSize{
      this,
      "point_size",
      1.0f,
      {1.0f, 16.0f},
      "",
      "side of a texel's point across the stacks, in voxels; above 1 it closes holes of an atlas "
      "with too few texels, and thickens what stands along the stacks"};

  void mark(PassContext& frame, const GridPlacement& grid, const gpu::Texture& words,
            const Draws& draws) override {
    atlas_.update(frame, static_cast<double>(grid.voxelSize) / static_cast<double>(texelsPerVoxel));
    GpuScene& scene = frame.scene();
    for (const SceneDraw* draw : draws) {
      const AtlasPart texels = atlas_.texelsOf(frame, *draw);
      if (texels.texelCount == 0) continue;
      binaryShader::Variant variant;
      variant.masks = frame.keepsEverything() || draw->maskTexture != nullptr;
      const gpu::Texture& mask = draw->maskTexture != nullptr ? *draw->maskTexture : scene.whiteTexture();
      frame.shaders().dispatch(
          frame.program(binaryShader::kProgram, variant.key()),
          {binaryShader::positions(scene.positions()), binaryShader::texcoords(scene.texcoords()),
           binaryShader::objects(scene.objects()), binaryShader::indices(scene.indices()),
           binaryShader::draw({draw->object, draw->material}),
           binaryShader::grid({grid.low, grid.voxelSize, grid.resolution, pointSize}),
           binaryShader::texels({static_cast<int>(texels.firstTexel), static_cast<int>(texels.texelCount)}),
           binaryShader::texelTriangles(atlas_.triangles()), binaryShader::texelPlaces(atlas_.places()),
           binaryShader::words(words), binaryShader::maskTexture(mask, gpu::Sampling::linearMipsRepeat)},
          workGroupsFor(texels.texelCount));
    }
    frame.device().barrier();
  }

  AtlasTexels atlas_;
};

}  // namespace

void addAtlasBinary(TechniqueRegistry& registry) {
  registry.add<AtlasBinaryPass>("atlas_binary",
                                "Bits from a texture atlas of the surface (Thiedemann et al. 2011)");
}

}  // namespace lumivox::voxelization
