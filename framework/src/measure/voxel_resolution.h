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

inline void requireSameResolution(const VoxelSet& occupied, const VoxelSet& truth) {
  if (occupied.resolution() != truth.resolution())
    throw Error(fmt::format("a grid of {} voxels cannot be compared with a truth of {}",
                            resolutionText(occupied.resolution()), resolutionText(truth.resolution())));
}

}  // namespace lumivox::measure
