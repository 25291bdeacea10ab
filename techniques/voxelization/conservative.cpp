// Finds every voxel that a triangle touches: by the rasteriser along the dominant axis in a single pass
// (Crassin & Green 2012, Sec. 22.3), or by a compute shader over triangles (Schwarz & Seidel 2010). Both find
// the same voxels.
#include <algorithm>
#include <map>

#include "voxelizer.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

/// Triangles of one draw for one work group: first index, number of triangles, object, material.
using Batch = glm::uvec4;
/// Draws that can share dispatches: those with the same textures.
using BatchesByTextures = std::map<std::pair<const gpu::Texture*, const gpu::Texture*>, std::vector<Batch>>;

BatchesByTextures batchesOf(const std::vector<const SceneDraw*>& draws) {
  BatchesByTextures result;
  for (const SceneDraw* draw : draws) {
    std::vector<Batch>& batches = result[{draw->diffuseTexture, draw->maskTexture}];
    const std::uint32_t triangles = draw->indexCount / 3;
    constexpr auto kGroup = static_cast<std::uint32_t>(kWorkGroupSize);
    for (std::uint32_t first = 0; first < triangles; first += kGroup) {
      batches.emplace_back(draw->firstIndex + 3 * first, std::min(triangles - first, kGroup), draw->object,
                           draw->material);
    }
  }
  return result;
}

class ConservativePass : public Voxelizer {
  enum class Depth { conservative, centre };
  enum class Method { automatic, raster, compute };

  Param<Depth> depth{
      this, "depth", Depth::conservative,
      "voxels along the projection axis; conservative: all that the triangle crosses; centre: only the voxel at the pixel's centre"};
  Param<Method> method{
      this, "method", Method::automatic,
      "how the voxels are found; raster: by the rasteriser; compute: by a compute shader; automatic: the faster of the two. All find the same voxels"};

  /// Rows of tiles that fit into the list of large triangles; further rows do without it.
  static constexpr std::uint32_t kRowCapacity = 1u << 17;
  static constexpr std::size_t kBatchesAtOnce =
      std::tuple_size_v<decltype(conservative_compute::Batches::batches)>;
  static constexpr std::uint64_t kRowHeadBytes = 4 * sizeof(std::uint32_t);

  void append(PassContext& frame, const VoxelFragments& list, const Draws& draws) override {
    if (method == Method::raster || (method == Method::automatic && !prefersCompute(frame, draws))) {
      rasterise(frame, list, draws);
    } else {
      compute(frame, list, draws);
    }
  }

  /// A software rasteriser gains nothing from fixed functions. On other devices a triangle smaller than a
  /// quad of pixels wastes most of them (Schwarz & Seidel 2010, Sec. 6). Surfaces fill about the grid's six
  /// sides.
  bool prefersCompute(PassContext& frame, const Draws& draws) const {
    if (frame.device().info().software) return true;
    constexpr double kSmallestForRaster = 4.0;  // pixels of a quad
    double triangles = 0.0;
    for (const SceneDraw* draw : draws) triangles += draw->indexCount / 3;
    return 6.0 * resolution * resolution < kSmallestForRaster * triangles;
  }

  void rasterise(PassContext& frame, const VoxelFragments& list, const Draws& draws) {
    const int side = list.grid.longest();
    const gpu::Drawing drawing = frame.device().drawTo({.width = side, .height = side}, {});
    const conservative::Constants constants{.depthRange = depth == Depth::conservative};
    for (const SceneDraw* draw : draws) {
      const SceneBinding scene(frame, *draw);
      frame.shaders().draw(frame.program(scene.in(conservative::Variant{}), constants),
                           {scene, appending(list), conservative::part({static_cast<int>(draw->firstIndex)})},
                           draw->indexCount);
    }
  }

  void compute(PassContext& frame, const VoxelFragments& list, const Draws& draws) {
    const gpu::BufferRef rows = frame.buffer(
        kRowHeadBytes + kRowCapacity * conservative_compute::rows.elementBytes, "rows of large triangles");
    for (const auto& [textures, batches] : batchesOf(draws)) {
      const std::span<const Batch> all(batches);
      for (std::size_t first = 0; first < all.size(); first += kBatchesAtOnce) {
        computeBatches(frame, list, textures.first, textures.second,
                       all.subspan(first, std::min(all.size() - first, kBatchesAtOnce)), rows);
      }
    }
  }

  void computeBatches(PassContext& frame, const VoxelFragments& list, const gpu::Texture* diffuse,
                      const gpu::Texture* mask, std::span<const Batch> batches, const gpu::BufferRef& rows) {
    const std::array<std::uint32_t, 4> noRows{0, 0, 1, 1};
    rows->uploadValues(std::span<const std::uint32_t>(noRows));
    conservative_compute::Batches table{};
    std::copy(batches.begin(), batches.end(), std::begin(table.batches));
    const SceneBinding scene(frame, diffuse, mask);
    auto variant = scene.in(conservative_compute::Variant{});
    const conservative_compute::Constants constants{.depthRange = depth == Depth::conservative};
    const shader::BindingSet bindings{scene, appending(list), conservative_compute::batches(table),
                                      conservative_compute::rows(rows),
                                      conservative_compute::limits({static_cast<int>(kRowCapacity)})};
    frame.shaders().dispatch(frame.program(variant, constants), bindings,
                             {static_cast<std::uint32_t>(batches.size()), 1, 1});
    frame.device().barrier();
    variant.large = 1;
    frame.dispatchIndirect(frame.program(variant, constants), bindings, *rows, sizeof(std::uint32_t));
  }
};

}  // namespace

void addConservative(TechniqueRegistry& registry) {
  registry.add<ConservativePass>("conservative",
                                 "Every voxel that a triangle touches, by rasterisation through the dominant "
                                 "axis (Crassin & Green 2012) or by compute (Schwarz & Seidel 2010)");
}

}  // namespace lumivox::voxelization
