// Where voxel grids lie.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>

namespace lumivox {

/// Where a cubic voxel grid lies. Voxel (i,j,k) covers low + [i,i+1] x [j,j+1] x [k,k+1] times voxelSize; its
/// centre is the half-way point.
struct GridPlacement {
  glm::vec3 low{0.0f};       ///< corner of voxel (0,0,0), metres relative to the snapshot's origin
  float voxelSize = 1.0f;    ///< m
  glm::ivec3 resolution{0};  ///< voxels per axis
  /// Voxels along the longest side.
  int longest() const { return std::max({resolution.x, resolution.y, resolution.z}); }
  /// All voxels.
  std::uint64_t voxelCount() const {
    const glm::u64vec3 size(resolution);
    return size.x * size.y * size.z;
  }
  bool operator==(const GridPlacement&) const = default;
};

}  // namespace lumivox
