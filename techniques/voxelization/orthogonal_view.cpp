#include "orthogonal_view.h"

#include <algorithm>

namespace lumivox::voxelization {

int viewSide(const GridPlacement& grid) {
  return std::max({grid.resolution.x, grid.resolution.y, grid.resolution.z});
}

OrthogonalView viewAlong(const VoxelFragments& list, int axis, float depthLow, float depthHigh) {
  OrthogonalView view{};
  view.gridLow = list.grid.low;
  view.voxelSize = list.grid.voxelSize;
  view.resolution = list.grid.resolution;
  view.capacity = static_cast<int>(list.capacity);
  view.side = static_cast<float>(viewSide(list.grid));
  view.axis = axis;
  view.depthLow = depthLow;
  view.depthHigh = depthHigh;
  return view;
}

gpu::ResourceBinding viewBinding(const OrthogonalView& view) {
  return shader::UniformSlot<OrthogonalView>{"View"}(view);
}

}  // namespace lumivox::voxelization
