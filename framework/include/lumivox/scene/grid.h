// Where voxel grids lie.
#pragma once

#include <glm/glm.hpp>

namespace lumivox {

/// Where a cubic voxel grid lies. Voxel (i,j,k) covers low + [i,i+1] x [j,j+1] x [k,k+1] times voxelSize; its
/// centre is the half-way point.
struct GridPlacement {
  glm::vec3 low{0.0f};       ///< corner of voxel (0,0,0), metres relative to the snapshot's origin
  float voxelSize = 1.0f;    ///< m
  glm::ivec3 resolution{0};  ///< voxels per axis
  bool operator==(const GridPlacement&) const = default;
};

}  // namespace lumivox
