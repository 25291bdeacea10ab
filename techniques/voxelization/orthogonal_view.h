// Views along the axes of a grid, one pixel a column of voxels: what slicing and depth peeling draw.
#pragma once

#include "voxelization_shaders.h"
#include "voxelizer.h"

namespace lumivox::voxelization {

using OrthogonalView = shaders::voxelization::View;

/// Pixels along a side of the square target of all views of a grid.
int viewSide(const GridPlacement& grid);

/// The slice between two depths, in voxels, along axis 0, 1 or 2.
OrthogonalView viewAlong(const VoxelFragments& list, int axis, float depthLow, float depthHigh);

/// The view's block.
gpu::ResourceBinding viewBinding(const OrthogonalView& view);

}  // namespace lumivox::voxelization
