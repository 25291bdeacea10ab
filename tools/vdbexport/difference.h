// Compares two OpenVDB grids voxel by voxel, also at different resolutions.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <string>

namespace lumivox::vdb {

/// Voxels are those active in either grid, on the lattice of the coarser one.
struct GridDifference {
  std::uint64_t voxels = 0;
  std::uint64_t differing = 0;   ///< their largest component differs by more than the tolerance
  std::uint64_t onlyFirst = 0;   ///< active in the first grid alone
  std::uint64_t onlySecond = 0;  ///< active in the second grid alone
  double largest = 0.0;          ///< absolute difference of any component; infinite if one is NaN
  double rms = 0.0;              ///< over voxels and components
  openvdb::Coord where;          ///< of the largest
  std::string lattice = "same";  ///< or "first" or "second": whose voxels the other was averaged onto

  /// Within the tolerance; at tolerance 0 the grids must also have the same active voxels.
  bool same(double tolerance) const {
    return differing == 0 && (tolerance > 0.0 || (onlyFirst == 0 && onlySecond == 0));
  }
};

/// Compares two grids of the same type: numbers, vectors or bools (as 0 and 1). They have the same linear
/// transform, or cubic voxels along the axes. If their lattices differ, the values of the finer grid, taken
/// as constant in each voxel, are averaged over each voxel of the coarser lattice. A coarse voxel counts as
/// active if an active finer one overlaps it. Error, naming `what`, for other transforms, other types and too
/// much memory.
GridDifference difference(const openvdb::GridBase& first, const openvdb::GridBase& second, double tolerance,
                          const std::string& what);

}  // namespace lumivox::vdb
