// Splits long loops of shaders into portions that every driver runs to the end.
#pragma once

#include <algorithm>
#include <cstdint>

namespace lumivox {

/// Limit of the loop iterations of one invocation, all loops together: software drivers end them silently at
/// 65535.
inline constexpr int kLoopLimit = 60000;

/// The number of items that one invocation may process, each with so many loop iterations of its own: at
/// least one, at most all.
constexpr int portionOf(int items, std::int64_t turnsOfEach) {
  return static_cast<int>(std::clamp<std::int64_t>(kLoopLimit / (turnsOfEach + 1), 1, std::max(items, 1)));
}

/// Calls `portion(first, count)` for consecutive items, each item once, so that an invocation over a portion
/// keeps to the limit. An item that exceeds the limit by itself has its own portion.
template <class Portion>
void forEachPortion(int items, std::int64_t turnsOfEach, Portion&& portion) {
  const int most = portionOf(items, turnsOfEach);
  for (int first = 0; first < items; first += most) portion(first, std::min(most, items - first));
}

}  // namespace lumivox
