#include "voxel_sums.h"

#include <algorithm>
#include <array>

#include "changed_cells.h"
#include "lumivox/toolkit/bindings.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

VoxelSums claimSums(PassContext& frame, const VoxelFragments& fragments, const glm::ivec3& size,
                    bool directional, OccupiedBricks& occupied) {
  VoxelSums sums;
  sums.directional = directional;
  sums.brickCount = (size + (OccupiedBricks::kSide - 1)) / OccupiedBricks::kSide;
  const std::uint64_t bricks = GridPlacement{.resolution = sums.brickCount}.voxelCount(),
                      voxels = std::min<std::uint64_t>(fragments.capacity,
                                                       GridPlacement{.resolution = size}.voxelCount());
  sums.bricks = frame.emptyElements(claim::bricks, bricks, "occupied voxels of bricks");
  sums.places = {add::bricks(sums.bricks)};
  sums.voxels = directional ? frame.emptyElements(add::directionalSums, voxels, "sums of voxels' faces")
                            : frame.emptyElements(add::sums, voxels, "sums of voxels");
  occupied.bricks = frame.elements(claim::brickList, std::min<std::uint64_t>(fragments.capacity, bricks),
                                   "occupied bricks");
  occupied.count = frame.buffer(OccupiedBricks::argumentsBytes(3), "occupied brick count");
  const gpu::BufferRef totals = frame.uploaded(std::array<std::uint32_t, 2>{}, "claimed bricks and voxels");
  const auto brickCount = claim::size({sums.brickCount});
  forEachFragment(frame, frame.program(mark::kProgram), {brickCount, mark::bricks(sums.bricks)}, fragments);
  frame.dispatch(
      frame.program(claim::kProgram),
      {brickCount, claim::bricks(sums.bricks), claim::brickList(occupied.bricks), claim::brickTotals(totals)},
      sums.brickCount);
  frame.dispatch(frame.program(arguments::kProgram),
                 {arguments::brickTotals(totals), arguments::brickCount(occupied.count)}, {1, 1, 1});
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
               {add::averages({sums.brickCount, fragments.coverage == VoxelFragments::Coverage::sum}),
                add::radiances(radiances), add::sideMasks(sums.sideMasks), sums.bindings()},
               fragments, sums);
}

}  // namespace lumivox::voxel_cone_tracing
