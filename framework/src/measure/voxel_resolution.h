// Resolutions in messages.
#pragma once

#include <fmt/format.h>

#include <string>

#include "lumivox/base/error.h"
#include "lumivox/measure/voxels.h"

namespace lumivox::measure {

inline std::string resolutionText(const glm::ivec3& resolution) {
  return fmt::format("{} x {} x {}", resolution.x, resolution.y, resolution.z);
}

[[noreturn]] inline void refuseResolutions(const glm::ivec3& occupied, const glm::ivec3& truth) {
  throw Error(fmt::format("a grid of {} voxels cannot be compared with a truth of {}",
                          resolutionText(occupied), resolutionText(truth)));
}

inline void requireSameResolution(const VoxelSet& occupied, const VoxelSet& truth) {
  if (occupied.resolution() != truth.resolution())
    refuseResolutions(occupied.resolution(), truth.resolution());
}

}  // namespace lumivox::measure
