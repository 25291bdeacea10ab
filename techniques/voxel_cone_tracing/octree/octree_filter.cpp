// The bricks of a sparse voxel octree: the pool, the leaves, and pre-filtering. Crassin et al. 2011, Sec. 4
// and 5; thesis Gomes 2015, Sec. 3.1.2 and 3.1.3.
#include <fmt/format.h>

#include <array>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "octree.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

/// Makes a pool for so many bricks, about a cube with less than one empty layer.
gpu::TextureRef pool(PassContext& frame, std::uint64_t bricks, gpu::Format format, int& shift) {
  shift = 0;
  while ((std::uint64_t{1} << (3 * (shift + 1))) <= bricks) ++shift;
  constexpr int kSide = VoxelOctree::kBrickSide;
  const int row = 1 << shift;
  const std::uint64_t layer = static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(row);
  return frame.volume({kSide * row, kSide * row, kSide * static_cast<int>((bricks + layer - 1) / layer)},
                      format, "octree bricks of radiance");
}

}  // namespace

void makePool(PassContext& frame, RadianceOctree& result, gpu::Format format, std::uint64_t bytesOfSums) {
  const VoxelOctree& tree = result.tree;
  const auto faces = static_cast<std::uint64_t>(result.faces);
  requireRoom(frame, tree, {.texels = faces * gpu::bytesPerTexel(format), .sums = bytesOfSums}, true);
  result.radiance = pool(frame, faces * tree.brickRoom, format, result.poolShift);
}

void resolveLeaves(PassContext& frame, const RadianceOctree& octree, const VoxelSums& sums, bool coverageSum,
                   const gpu::BufferRef& reflected) {
  const VoxelOctree& tree = octree.tree;
  forEachBrick(
      frame,
      frame.program(octree_resolve::Variant{.changed = sums.changed != nullptr,
                                            .directions = sums.directional,
                                            .reflected = reflected != nullptr}),
      {octree_resolve::leaves({.unit = octree.unit, .coverageSum = coverageSum}),
       octree_resolve::radianceImage(octree.radiance), octree_resolve::reflected(reflected), sums.bindings()},
      tree, tree.depth, sums.changed != nullptr ? 1 : VoxelOctree::kBrickVoxels);
}

namespace {

/// Voxels of a depth from those of the next one; in the order of octree_filter.comp.
enum class Halving { facing, average };
void halve(PassContext& frame, const RadianceOctree& octree, int depth, Halving rule) {
  forEachBrick(frame,
               frame.program(
                   octree_filter::Variant{.changed = octree.still != nullptr, .directions = octree.faces > 1},
                   octree_filter::Constants{.rule = static_cast<int>(rule)}),
               {octree_filter::coarse({depth}), octree_filter::pool(octree.radiance, gpu::Sampling::nearest),
                octree_filter::poolImage(octree.radiance), OctreeBinding(octree.tree, octree.poolShift),
                stillBinding(octree)},
               octree.tree, depth, VoxelOctree::kBrickVoxels);
}

}  // namespace

void fillLevels(PassContext& frame, RadianceOctree& octree) {
  for (int depth = octree.tree.depth - 1; depth >= 0; --depth) halve(frame, octree, depth, Halving::facing);
  octree.filledLevels = octree.tree.depth + 1;
}

namespace {

class OctreeFilterPass : public Pass {
  using Opacity = Halving;

  In<RadianceOctree> radiance{this, "radiance", "the finest level"};
  Param<Opacity> opacity{
      this, "opacity", Opacity::facing,
      "opacity of a coarse voxel; facing: that of the finer voxels seen along the axis that they face; average: their mean"};
  Out<RadianceOctree> mips{this, "mips", "the same octree with values at all depths", Levels::all};

  void run(PassContext& frame) override {
    RadianceOctree result = *radiance;
    if (result.faces > 1 && opacity != Opacity::facing)
      throw Error(
          "voxel_cone_tracing.octree_filter: each of the six faces of a coarse voxel is what is seen through it along its axis, and 'opacity average' has no sides; expected 'opacity facing', or 'faces one' in voxel_cone_tracing.octree_inject");
    if (result.still != nullptr)
      result.still = frame.kept("levels of static geometry", result.still, [&] {
        for (int depth = result.tree.depth - 1; depth >= 0; --depth)
          halve(frame, *result.still, depth, opacity);
        return result.still;
      });
    for (int depth = result.tree.depth - 1; depth >= 0; --depth) halve(frame, result, depth, opacity);
    result.still = nullptr;
    result.filledLevels = result.tree.depth + 1;
    result.opacity = opacity == Opacity::facing ? RadianceOctree::Opacity::ofVoxel
                                                : RadianceOctree::Opacity::ofFinestVoxel;
    mips = result;
  }
};

}  // namespace

void addOctreeFilter(TechniqueRegistry& registry) {
  registry.add<OctreeFilterPass>("octree_filter",
                                 "Pre-filtered bricks above the leaves (Crassin et al. 2011, Sec. 5)");
}

}  // namespace lumivox::voxel_cone_tracing
