// The bricks of a sparse voxel octree: the pool, what neighbours share, and pre-filtering. Crassin et al.
// 2011, Sec. 4 to 6; thesis Gomes 2015, Sec. 3.1.2, 3.1.3 and 4.2.2.
#include <fmt/format.h>

#include <array>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "octree.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

/// Room for so many bricks of so many voxels a side, about a cube of them: less than a layer of it stays
/// empty.
gpu::TextureRef pool(PassContext& frame, std::uint64_t bricks, int side, gpu::Format format, int& shift) {
  shift = 0;
  while ((std::uint64_t{1} << (3 * (shift + 1))) <= bricks) ++shift;
  const int row = 1 << shift;
  const std::uint64_t layer = static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(row);
  return frame.volume({side * row, side * row, side * static_cast<int>((bricks + layer - 1) / layer)}, format,
                      "octree bricks of radiance");
}

}  // namespace

gpu::BufferRef makePool(PassContext& frame, RadianceOctree& result, gpu::Format format,
                        const shader::StorageSlot& sums) {
  const VoxelOctree& tree = result.tree;
  const auto faces = static_cast<std::uint64_t>(result.faces);
  requireRoom(frame, tree, {.texels = faces * gpu::bytesPerTexel(format), .sums = sums.elementBytes}, true);
  result.radiance = pool(frame, faces * tree.brickRoom, tree.brickSide(), format, result.poolShift);
  return frame.emptyElements(sums, 8 * tree.leafRoom, "sums of voxels");
}

void transferBorders(PassContext& frame, const RadianceOctree& octree, int depth, Transfer way) {
  if (octree.tree.bricksAre == VoxelOctree::Bricks::own) return;
  const auto along = [&](int axis, Transfer how) {
    forEachBrick(
        frame,
        frame.program(octree_transfer::Variant{}, octree_transfer::Constants{.way = static_cast<int>(how)}),
        {octree_transfer::borders({depth, axis, octree.faces}),
         octree_transfer::pool(octree.radiance, gpu::Sampling::nearest),
         octree_transfer::poolImage(octree.radiance), OctreeBinding(octree.tree, octree.poolShift)},
        octree.tree, depth, 9);
  };
  for (int axis = 0; axis < 3; ++axis) {
    along(axis, way);
    if (way == Transfer::add) along(axis, Transfer::copy);
  }
}

void resolveLeaves(PassContext& frame, const RadianceOctree& octree, const VoxelSums& sums,
                   bool coverageSum) {
  const VoxelOctree& tree = octree.tree;
  const bool inLeaves = tree.voxels == VoxelOctree::Voxels::inLeaves;
  forEachBrick(
      frame,
      frame.program(
          octree_resolve::Variant{.changed = sums.changed != nullptr, .directions = sums.directional}),
      {octree_resolve::leaves({.unit = octree.unit, .coverageSum = coverageSum, .inLeaves = inLeaves}),
       octree_resolve::radianceImage(octree.radiance), sums.bindings()},
      tree, tree.depth, sums.changed != nullptr ? 1 : tree.brickVoxels());
  transferBorders(frame, octree, tree.depth, inLeaves ? Transfer::average : Transfer::copy);
}

void addParts(PassContext& frame, const RadianceOctree& octree, int depth, bool means) {
  constexpr std::array<int, 4> kPartThreads{1, 6, 12, 8};
  for (int part = 0; part < 4; ++part)
    forEachBrick(
        frame, frame.program(octree_filter_part::Variant{}, octree_filter_part::Constants{.part = part}),
        {octree_filter_part::parts({.depth = depth, .means = means}),
         octree_filter_part::pool(octree.radiance, gpu::Sampling::nearest),
         octree_filter_part::poolImage(octree.radiance), OctreeBinding(octree.tree, octree.poolShift)},
        octree.tree, depth, kPartThreads[static_cast<std::size_t>(part)]);
  transferBorders(frame, octree, depth, means ? Transfer::average : Transfer::add);
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
               octree.tree, depth, octree.tree.brickVoxels());
  transferBorders(frame, octree, depth, Transfer::copy);
}

}  // namespace

void fillLevels(PassContext& frame, RadianceOctree& octree) {
  for (int depth = octree.tree.depth - 1; depth >= 0; --depth) halve(frame, octree, depth, Halving::facing);
  octree.filledLevels = octree.tree.depth + 1;
}

namespace {

class OctreeFilterPass : public Pass {
  using Opacity = Halving;
  enum class Borders { added, averaged };

  In<RadianceOctree> radiance{this, "radiance", "the finest level"};
  Param<Opacity> opacity{
      this, "opacity", Opacity::facing,
      "how finer voxels make a coarse one: seen through along the axis that they face; or their mean, which with voxels at corners or in leaves has the weights 1, 2, 1 along each axis, as published"};
  Param<Borders> borders{
      this, "borders", Borders::added,
      "with voxels at corners or in leaves, how bricks complete those of which their neighbours know a part: parts are added to the right and copied to the left (Crassin et al. 2011); parts are means, and averaged (as published in the thesis)"};
  Out<RadianceOctree> mips{this, "mips", "the same octree with values at all depths", Levels::all};

  void run(PassContext& frame) override {
    RadianceOctree result = *radiance;
    const bool asGrid = result.tree.voxels == VoxelOctree::Voxels::asGrid;
    if (!asGrid && opacity == Opacity::facing)
      throw Error(
          "voxel_cone_tracing.octree_filter: 'opacity facing' takes eight whole voxels for a coarse one, and with voxels at corners or in leaves it covers halves of others; expected 'opacity average', or 'voxels as_grid' in voxel_cone_tracing.octree");
    if (result.faces > 1 && opacity != Opacity::facing)
      throw Error(
          "voxel_cone_tracing.octree_filter: each of the six faces of a coarse voxel is what is seen through it along its axis, and 'opacity average' has no sides; expected 'opacity facing', or 'faces one' in voxel_cone_tracing.octree_inject");
    if (result.still != nullptr)
      result.still = frame.kept("levels of static geometry", result.still, [&] {
        for (int depth = result.tree.depth - 1; depth >= 0; --depth)
          halve(frame, *result.still, depth, opacity);
        return result.still;
      });
    for (int depth = result.tree.depth - 1; depth >= 0; --depth) {
      if (asGrid) {
        halve(frame, result, depth, opacity);
      } else {
        addParts(frame, result, depth, borders == Borders::averaged);
      }
    }
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
