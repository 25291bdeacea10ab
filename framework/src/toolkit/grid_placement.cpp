#include "lumivox/toolkit/grid_placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lumivox {
namespace {

constexpr int kSmallestWithMargin =
    8;  // voxels along a side below which the empty margin would cost too much

}  // namespace

GridPlacement placeGrid(const Bounds& bounds, int resolution) {
  assert(resolution >= 1 && resolution <= kLargestGrid);
  GridPlacement grid;
  const glm::vec3 low = bounds.empty ? glm::vec3(-0.5f) : bounds.low;
  const glm::vec3 extent = bounds.empty ? glm::vec3(1.0f) : bounds.high - bounds.low;
  const float longest = std::max({extent.x, extent.y, extent.z, 1e-6f});
  const int margin = resolution >= kSmallestWithMargin ? 1 : 0;
  grid.voxelSize = longest / static_cast<float>(resolution - 2 * margin);
  // Half a thousandth of a voxel more keeps rounding from placing a wall on the bounds between two voxels.
  grid.voxelSize *= 1.0005f;
  for (int axis = 0; axis < 3; ++axis) {
    // A flat scene lies in the middle of a voxel, not between two.
    const int cells = std::max(static_cast<int>(std::ceil(extent[axis] / grid.voxelSize)), 1) + 2 * margin;
    grid.resolution[axis] = std::clamp(cells, 1, resolution);
    const float slack = static_cast<float>(grid.resolution[axis]) * grid.voxelSize - extent[axis];
    grid.low[axis] = low[axis] - 0.5f * slack;
  }
  return grid;
}

GridPlacement placeGridAround(const glm::vec3& centre, float extent, int resolution) {
  assert(extent > 0.0f && resolution >= 1 && resolution <= kLargestGrid);
  GridPlacement grid;
  grid.resolution = glm::ivec3(resolution);
  grid.voxelSize = extent / static_cast<float>(resolution);
  const double voxel = grid.voxelSize;
  // The middle is rounded, not the corner: a camera in the middle of the scene is common, and rounding must
  // not decide between two voxels there.
  const glm::dvec3 middle = glm::round(glm::dvec3(centre) / voxel);
  grid.low = glm::vec3((middle - 0.5 * static_cast<double>(resolution)) * voxel);
  return grid;
}

GridPlacement placeNestedGrid(const glm::vec3& centre, float finestExtent, int resolution, int level) {
  return placeGridAround(centre, std::ldexp(finestExtent, level), resolution);
}

std::string inWords(const GridPlacement& grid) {
  return fmt::format("{} x {} x {} voxels of {:g} m from ({:g}, {:g}, {:g}) on", grid.resolution.x,
                     grid.resolution.y, grid.resolution.z, grid.voxelSize, grid.low.x, grid.low.y,
                     grid.low.z);
}

}  // namespace lumivox
