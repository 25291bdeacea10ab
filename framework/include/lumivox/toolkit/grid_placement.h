// Where voxel grids go: around the scene, or around the camera.
#pragma once

#include <string>

#include "lumivox/scene/grid.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// Most voxels along a side: 10 bits per axis in VoxelFragment::voxel.
inline constexpr int kLargestGrid = 1024;

/// A cubic-voxel grid around `bounds`, `resolution` voxels along its longest side and as many as needed along
/// the others. One empty voxel lies on every side, so that filtering at the border reads empty space and a
/// surface on the bounds lies inside; a resolution below 8 is used without that margin. Empty bounds give a
/// grid of one metre around the origin.
GridPlacement placeGrid(const Bounds& bounds, int resolution);

/// A cube of `resolution` voxels and `extent` metres a side around `centre`, whose middle lies on a whole
/// multiple of the voxel size, so that it moves by whole voxels and what is stored in it does not flicker.
/// Multiples count from the snapshot's origin, which is bound to the scene: a scene that is moved or scaled
/// as a whole, its camera with it, has the same voxels. A function of its arguments alone.
GridPlacement placeGridAround(const glm::vec3& centre, float extent, int resolution);

/// The same for nested grids: level 0 is the finest, each next one has voxels of twice the size and its
/// middle on a whole multiple of its own.
GridPlacement placeNestedGrid(const glm::vec3& centre, float finestExtent, int resolution, int level);

/// "64 x 64 x 32 voxels of 0.1 m from (0, 0, 0) on".
std::string inWords(const GridPlacement& grid);

}  // namespace lumivox
