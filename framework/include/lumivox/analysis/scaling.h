// How the times of voxelisers grow.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lumivox/results/voxelisers.h"

namespace lumivox {

/// How a voxeliser's time grows: the exponent p of a power law time ~ x^p through the medians (least squares
/// in logarithms).
struct VoxeliserScaling {
  std::string scene, label;
  std::optional<double> withResolution;  ///< x: voxels along a side; at least two resolutions
  std::optional<double> withTriangles;   ///< x: triangles; at least two numbers of them
};
std::vector<VoxeliserScaling> scalingOf(const std::vector<VoxeliserRecord>& records);

}  // namespace lumivox
