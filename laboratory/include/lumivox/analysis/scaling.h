// How the times of voxelizers grow.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lumivox/results/voxelizers.h"

namespace lumivox {

/// How a voxelizer's time grows: the exponent p of a power law time ~ x^p through the medians (least squares
/// in logarithms).
struct VoxelizerScaling {
  std::string scene, label;
  std::optional<double> withResolution;  ///< x: voxels along a side; at least two resolutions
  std::optional<double> withTriangles;   ///< x: triangles; at least two numbers of them
};
std::vector<VoxelizerScaling> scalingOf(const std::vector<VoxelizerRecord>& records);

}  // namespace lumivox
