// Long loops of shaders in portions that every driver runs to their end.
#pragma once

#include <algorithm>
#include <cstdint>

namespace lumivox {

/// Turns of all loops of an invocation together: software drivers cut them off, without a word, at 65535.
inline constexpr int kLoopLimit = 60000;

/// How many of so many items an invocation may take, each with loops of so many turns beside its own one: at
/// least one, and at most all.
constexpr int portionOf(int items, std::int64_t turnsOfEach) {
  return static_cast<int>(std::clamp<std::int64_t>(kLoopLimit / (turnsOfEach + 1), 1, std::max(items, 1)));
}

/// Calls `portion(first, count)` for items in a row, each item once, so that an invocation that takes such a
/// portion keeps to the limit. An item that goes beyond it by itself has a portion to itself.
template <class Portion>
void forEachPortion(int items, std::int64_t turnsOfEach, Portion&& portion) {
  const int most = portionOf(items, turnsOfEach);
  for (int first = 0; first < items; first += most) portion(first, std::min(most, items - first));
}

}  // namespace lumivox
