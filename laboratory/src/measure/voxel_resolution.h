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

[[noreturn]] inline void refuseResolutions(const glm::ivec3& occupied, const glm::ivec3& reference) {
  throw Error(fmt::format("a grid of {} voxels cannot be compared with a reference of {}",
                          resolutionText(occupied), resolutionText(reference)));
}

inline void requireSameResolution(const VoxelSet& occupied, const VoxelSet& reference) {
  if (occupied.resolution() != reference.resolution())
    refuseResolutions(occupied.resolution(), reference.resolution());
}

}  // namespace lumivox::measure
