#include "voxel_sums.h"

#include <algorithm>
#include <array>

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

/// Places without sums, and only the number of bricks.
VoxelSums placed(const glm::ivec3& size, bool directional) {
  VoxelSums sums;
  sums.directional = directional;
  sums.brickCount = (size + (OccupiedBricks::kSide - 1)) / OccupiedBricks::kSide;
  return sums;
}
std::uint64_t bricksOf(const VoxelSums& sums) {
  return GridPlacement{.resolution = sums.brickCount}.voxelCount();
}
/// At most as many voxels as fragments are occupied.
std::uint64_t mostSums(const VoxelFragments& fragments, const glm::ivec3& size) {
  return std::min<std::uint64_t>(fragments.capacity, GridPlacement{.resolution = size}.voxelCount());
}

/// A list of at most so many bricks, and their totals.
struct BrickRoom {
  OccupiedBricks bricks;
  gpu::BufferRef totals;

  BrickRoom(PassContext& frame, std::uint64_t most, const std::string& label)
      : bricks{frame.elements(claim::brickList, most, label),
               frame.buffer(OccupiedBricks::argumentsBytes(3), label + ": how many")},
        totals(frame.uploaded(std::array<std::uint32_t, 2>{}, "claimed bricks and voxels")) {}
  /// Makes the dispatches over the bricks.
  void finish(PassContext& frame) const {
    frame.dispatch(frame.program(arguments::kProgram),
                   {arguments::brickTotals(totals), arguments::brickCount(bricks.count)}, {1, 1, 1});
  }
};

}  // namespace

VoxelSums claimSums(PassContext& frame, const VoxelFragments& fragments, const glm::ivec3& size,
                    bool directional, OccupiedBricks& occupied) {
  VoxelSums sums = placed(size, directional);
  sums.bricks = frame.emptyElements(claim::bricks, bricksOf(sums), "occupied voxels of bricks");
  sums.places = {add::bricks(sums.bricks)};
  const std::uint64_t voxels = mostSums(fragments, size);
  sums.voxels = directional ? frame.emptyElements(add::directionalSums, voxels, "sums of voxels' faces")
                            : frame.emptyElements(add::sums, voxels, "sums of voxels");
  const BrickRoom room(frame, std::min(fragments.capacity, bricksOf(sums)), "occupied bricks");
  const auto brickCount = claim::size({sums.brickCount});
  forEachFragment(frame, frame.program(mark::Variant{}), {brickCount, mark::bricks(sums.bricks)}, fragments);
  frame.dispatch(frame.program(claim::Variant{}),
                 {brickCount, claim::bricks(sums.bricks), claim::brickList(room.bricks.bricks),
                  claim::brickTotals(room.totals)},
                 sums.brickCount);
  room.finish(frame);
  occupied = room.bricks;
  return sums;
}

VoxelSums claimChanged(PassContext& frame, const VoxelFragments& fragments, const glm::ivec3& size,
                       bool directional, const ChangedCells& changed, const gpu::BufferRef& bricks,
                       OccupiedBricks& occupied, OccupiedBricks& changedBricks) {
  VoxelSums sums = placed(size, directional);
  sums.changed = &changed;
  sums.bricks = bricks;
  sums.places = {add::bricks(sums.bricks)};
  const std::uint64_t voxels = mostSums(fragments, size);
  sums.voxels = directional ? frame.elements(add::directionalSums, voxels, "sums of voxels' faces")
                            : frame.elements(add::sums, voxels, "sums of voxels");
  const BrickRoom all(frame, std::min(fragments.capacity, bricksOf(sums)), "occupied bricks"),
      // Voxels that were occupied before may be empty now.
      some(frame, std::min(2 * fragments.capacity, bricksOf(sums)), "changed bricks");
  const shader::BindingSet bindings{claim::size({sums.brickCount}), changed.bindings(), sums.bindings()};
  frame.dispatch(frame.program(changed_bricks::kProgram), bindings, sums.brickCount);
  forEachTaken(frame, frame.program(mark::Variant{.changed = 1}), bindings, fragments, sums);
  frame.dispatch(frame.program(claim::Variant{.changed = 1, .directions = directional}),
                 {bindings, claim::brickList(all.bricks.bricks), claim::brickTotals(all.totals),
                  claim::changedBrickList(some.bricks.bricks), claim::changedTotals(some.totals)},
                 sums.brickCount);
  all.finish(frame);
  some.finish(frame);
  occupied = all.bricks;
  changedBricks = some.bricks;
  return sums;
}

gpu::BufferRef radiancesOf(PassContext& frame, const VoxelFragments& fragments, const VoxelSums& sums) {
  return frame.buffer(std::max<std::uint64_t>(fragments.capacity, 1) * (sums.directional ? 6 : 3) *
                          add::radiances.elementBytes,
                      "reflected radiance per fragment");
}

void forEachTaken(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                  const VoxelFragments& fragments, const VoxelSums& sums) {
  if (sums.changed != nullptr) {
    forEachChanged(frame, program, bindings, fragments, *sums.changed);
  } else {
    forEachFragment(frame, program, bindings, fragments);
  }
}

void addUp(PassContext& frame, const VoxelFragments& fragments, const VoxelSums& sums,
           const gpu::BufferRef& radiances) {
  const add::Variant variant{.directions = sums.directional,
                             .sampled = sums.sideMasks != nullptr,
                             .places = sums.kind,
                             .changed = sums.changed != nullptr};
  forEachTaken(frame, frame.program(variant),
               {add::averages({.brickCount = sums.brickCount,
                               .coverageSum = fragments.coverage == VoxelFragments::Coverage::sum,
                               .backWeight = sums.faces.backWeight,
                               .alongAll = sums.faces.alongAll}),
                add::radiances(radiances), add::sideMasks(sums.sideMasks), sums.bindings()},
               fragments, sums);
}

}  // namespace lumivox::voxel_cone_tracing
