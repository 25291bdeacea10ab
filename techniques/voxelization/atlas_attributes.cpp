// Fragments from a texture atlas of the surface (multi-valued voxelisation of Thiedemann et al. 2011).
#include "atlas_texels.h"
#include "fragment_list.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {
namespace {

namespace attributeShader = shaders::voxelization::atlas_attributes;

class AtlasAttributesPass : public Voxeliser {
  Param<float> texelsPerVoxel{this, "texels_per_voxel",    kTexelsPerVoxel, kTexelsPerVoxelRange,
                              "",   kTexelsPerVoxelMeaning};

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    atlas_.update(frame, static_cast<double>(list.grid.voxelSize) / static_cast<double>(texelsPerVoxel));
    GpuScene& scene = frame.scene();
    for (const SceneDraw* draw : draws) {
      const AtlasPart texels = atlas_.texelsOf(frame, *draw);
      if (texels.texelCount == 0) continue;
      attributeShader::Variant variant;
      variant.textures = frame.keepsEverything() || draw->diffuseTexture != nullptr;
      variant.masks = frame.keepsEverything() || draw->maskTexture != nullptr;
      const gpu::Texture& diffuse =
          draw->diffuseTexture != nullptr ? *draw->diffuseTexture : scene.whiteTexture();
      const gpu::Texture& mask = draw->maskTexture != nullptr ? *draw->maskTexture : scene.whiteTexture();
      frame.shaders().dispatch(
          frame.program(attributeShader::kProgram, variant.key()),
          {attributeShader::positions(scene.positions()), attributeShader::normals(scene.normals()),
           attributeShader::texcoords(scene.texcoords()), attributeShader::objects(scene.objects()),
           attributeShader::materials(scene.materials()), attributeShader::indices(scene.indices()),
           attributeShader::draw({draw->object, draw->material}),
           attributeShader::grid(
               {list.grid.low, list.grid.voxelSize, list.grid.resolution, static_cast<int>(list.capacity)}),
           attributeShader::texels(
               {static_cast<int>(texels.firstTexel), static_cast<int>(texels.texelCount)}),
           attributeShader::texelTriangles(atlas_.triangles()), attributeShader::texelPlaces(atlas_.places()),
           attributeShader::count(*list.count), attributeShader::fragments(*list.fragments),
           attributeShader::diffuseTexture(diffuse, gpu::Sampling::linearMipsRepeat),
           attributeShader::maskTexture(mask, gpu::Sampling::linearMipsRepeat)},
          workGroupsFor(texels.texelCount));
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
