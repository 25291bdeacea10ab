// Lists longer than a row of work groups may be. Shader side: shaders/common/list.glsl.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>

namespace lumivox {

/// Most work groups along an axis that OpenGL promises (4.5, table 23.72).
inline constexpr std::uint64_t kMostGroupsAlong = 65535;

/// Items for PassContext::dispatch of a list, in groups of (groupSize, 1, 1): as many rows of groups as the
/// list needs. Precondition: at most kMostGroupsAlong squared groups.
inline glm::ivec3 listItems(std::uint64_t count, int groupSize) {
  const auto size = static_cast<std::uint64_t>(groupSize);
  const std::uint64_t groups = (count + size - 1) / size;
  const std::uint64_t columns = std::min(groups, kMostGroupsAlong);
  const std::uint64_t rows = columns == 0 ? 0 : (groups + columns - 1) / columns;
  return {static_cast<int>(columns * size), static_cast<int>(rows), 1};
}

}  // namespace lumivox
