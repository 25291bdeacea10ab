// Triangles to voxel fragments. One pass per voxeliser, all with the same output, so that any gathering
// technique can use any of them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/gpu_scene.h"
#include "lumivox/plugin/technique.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {
namespace {

namespace conservativeShader = shaders::voxelization::conservative;
namespace finishShader = shaders::voxelization::finish;

constexpr std::uint64_t kFragmentBytes =
    5 * sizeof(std::uint32_t);            // VoxelFragment in shaders/common/voxel.glsl
constexpr int kWorkGroupSize = 64;        // of the passes that read the list
constexpr int kLargestResolution = 1024;  // 10 bits per axis in VoxelFragment::voxel

/// A cubic-voxel grid around the scene. One empty voxel lies on every side, so that filtering at the border
/// reads empty space and a surface on the bounds lies inside. A resolution too small for that margin is used
/// without it.
GridPlacement placeGrid(const Bounds& bounds, int resolution) {
  GridPlacement grid;
  const glm::vec3 low = bounds.empty ? glm::vec3(-0.5f) : bounds.low;
  const glm::vec3 extent = bounds.empty ? glm::vec3(1.0f) : bounds.high - bounds.low;
  const float longest = std::max({extent.x, extent.y, extent.z, 1e-6f});
  const int margin = resolution >= 8 ? 1 : 0;
  grid.voxelSize = longest / static_cast<float>(resolution - 2 * margin);
  // Half of a thousandth of a voxel keeps a wall on the bounds from falling between two voxels by rounding.
  grid.voxelSize *= 1.0005f;
  for (int axis = 0; axis < 3; ++axis) {
    const int cells = static_cast<int>(std::ceil(extent[axis] / grid.voxelSize)) + 2 * margin;
    grid.resolution[axis] = std::clamp(cells, 1, resolution);
    const float slack = static_cast<float>(grid.resolution[axis]) * grid.voxelSize - extent[axis];
    grid.low[axis] = low[axis] - 0.5f * slack;
  }
  return grid;
}

class ConservativePass : public Pass {
  Param<int> resolution{
      this, "resolution", 64, {1, kLargestResolution}, "voxels along the longest side of the scene"};
  Param<std::string> depth{
      this,
      "depth",
      "conservative",
      {"conservative", "centre"},
      "voxels along the projection: all that the triangle crosses, or only the one at the pixel's centre"};
  Out<VoxelFragments> fragments{this, "fragments",
                                "one surface sample per triangle and voxel that it touches"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials; }

  std::uint64_t capacity_ = 0;

  void run(PassContext& frame) override {
    VoxelFragments result;
    result.grid = placeGrid(frame.snapshot().bounds, resolution);
    result.workGroupSize = kWorkGroupSize;
    result.count = frame.buffer(4 * sizeof(std::uint32_t), "voxel fragment count");
    if (capacity_ == 0) {
      // Surfaces fill about as many voxels as six sides of the grid; every triangle touches at least one,
      // mostly a few.
      const std::uint64_t side = static_cast<std::uint64_t>(resolution);
      capacity_ = 12 * side * side + 4 * frame.sceneDescription().triangleCount();
    }
    // A list that was too small is made anew with the size that it turned out to need; a frame like the last
    // one fits at once.
    for (;;) {
      result.capacity = capacity_;
      result.fragments = frame.buffer(capacity_ * kFragmentBytes, "voxel fragments");
      draw(frame, result);
      std::uint32_t count = 0;
      const std::vector<std::byte> word = result.count->download(0, sizeof(count));
      std::memcpy(&count, word.data(), sizeof(count));
      if (count <= capacity_) break;
      if (count > 0x7fffffffu)
        throw Error(fmt::format("voxelization: {} fragments do not fit into one list", count));
      capacity_ = count;
    }
    frame.dispatch(frame.program(finishShader::kProgram),
                   {finishShader::count(*result.count),
                    finishShader::parameters({static_cast<int>(capacity_), kWorkGroupSize})},
                   {1, 1, 1}, {1, 1, 1});
    fragments = result;
  }

  void draw(PassContext& frame, const VoxelFragments& result) const {
    GpuScene& scene = frame.scene();
    result.count->clear(0);
    gpu::RenderTargets targets;
    targets.width = targets.height =
        std::max({result.grid.resolution.x, result.grid.resolution.y, result.grid.resolution.z});
    frame.device().beginDrawing(targets, {});
    conservativeShader::Grid grid{};
    grid.gridLow = result.grid.low;
    grid.voxelSize = result.grid.voxelSize;
    grid.resolution = result.grid.resolution;
    grid.capacity = static_cast<int>(result.capacity);
    grid.depthRange = depth == "conservative" ? 1 : 0;
    for (const SceneDraw& draw : scene.draws()) {
      grid.firstIndex = static_cast<int>(draw.firstIndex);
      conservativeShader::Variant variant;
      variant.textures = frame.keepsEverything() || draw.diffuseTexture != nullptr;
      variant.masks = frame.keepsEverything() || draw.maskTexture != nullptr;
      const gpu::Texture& diffuse =
          draw.diffuseTexture != nullptr ? *draw.diffuseTexture : scene.whiteTexture();
      const gpu::Texture& mask = draw.maskTexture != nullptr ? *draw.maskTexture : scene.whiteTexture();
      frame.shaders().draw(
          frame.program(conservativeShader::kProgram, variant.key()),
          {conservativeShader::positions(scene.positions()), conservativeShader::normals(scene.normals()),
           conservativeShader::texcoords(scene.texcoords()), conservativeShader::objects(scene.objects()),
           conservativeShader::materials(scene.materials()), conservativeShader::indices(scene.indices()),
           conservativeShader::grid(grid), conservativeShader::draw({draw.object, draw.material}),
           conservativeShader::count(*result.count), conservativeShader::fragments(*result.fragments),
           conservativeShader::diffuseTexture(diffuse, gpu::Sampling::linearMipsRepeat),
           conservativeShader::maskTexture(mask, gpu::Sampling::linearMipsRepeat)},
          draw.indexCount);
    }
    frame.device().endDrawing();
    frame.device().barrier();
  }
};

}  // namespace
}  // namespace lumivox::voxelization

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::voxelization;
  registry.describe("Voxelisers: triangles to voxel fragments",
                    "Crassin & Green 2012; Schwarz & Seidel 2010; thesis Gomes 2015, Sec. 2.1.2, 4.2.1");
  registry.add<ConservativePass>(
      "conservative",
      "Single-pass conservative rasterisation through the dominant axis (Crassin & Green 2012)");
}
