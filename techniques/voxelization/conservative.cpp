// Single-pass conservative rasterisation through the dominant axis (Crassin & Green 2012, Sec. 22.3).
#include "voxeliser.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {
namespace {

namespace conservativeShader = shaders::voxelization::conservative;

class ConservativePass : public Voxeliser {
  Param<std::string> depth{
      this,
      "depth",
      "conservative",
      {"conservative", "centre"},
      "voxels along the projection: all that the triangle crosses, or only the one at the pixel's centre"};

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    GpuScene& scene = frame.scene();
    gpu::RenderTargets targets;
    targets.width = targets.height =
        std::max({list.grid.resolution.x, list.grid.resolution.y, list.grid.resolution.z});
    frame.device().beginDrawing(targets, {});
    conservativeShader::Grid grid{};
    grid.gridLow = list.grid.low;
    grid.voxelSize = list.grid.voxelSize;
    grid.resolution = list.grid.resolution;
    grid.capacity = static_cast<int>(list.capacity);
    grid.depthRange = depth == "conservative" ? 1 : 0;
    for (const SceneDraw* draw : draws) {
      grid.firstIndex = static_cast<int>(draw->firstIndex);
      conservativeShader::Variant variant;
      variant.textures = frame.keepsEverything() || draw->diffuseTexture != nullptr;
      variant.masks = frame.keepsEverything() || draw->maskTexture != nullptr;
      const gpu::Texture& diffuse =
          draw->diffuseTexture != nullptr ? *draw->diffuseTexture : scene.whiteTexture();
      const gpu::Texture& mask = draw->maskTexture != nullptr ? *draw->maskTexture : scene.whiteTexture();
      frame.shaders().draw(
          frame.program(conservativeShader::kProgram, variant.key()),
          {conservativeShader::positions(scene.positions()), conservativeShader::normals(scene.normals()),
           conservativeShader::texcoords(scene.texcoords()), conservativeShader::objects(scene.objects()),
           conservativeShader::materials(scene.materials()), conservativeShader::indices(scene.indices()),
           conservativeShader::grid(grid), conservativeShader::draw({draw->object, draw->material}),
           conservativeShader::count(*list.count), conservativeShader::fragments(*list.fragments),
           conservativeShader::diffuseTexture(diffuse, gpu::Sampling::linearMipsRepeat),
           conservativeShader::maskTexture(mask, gpu::Sampling::linearMipsRepeat)},
          draw->indexCount);
    }
    frame.device().endDrawing();
  }
};

}  // namespace

void addConservative(TechniqueRegistry& registry) {
  registry.add<ConservativePass>(
      "conservative",
      "Single-pass conservative rasterisation through the dominant axis (Crassin & Green 2012)");
}

}  // namespace lumivox::voxelization
