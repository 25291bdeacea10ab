// Median and quartiles of repeated measurements.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lumivox {

/// Median and quartiles.
struct Spread {
  double lower, median, upper;
};
/// Needs at least one value.
inline Spread spreadOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {values[n / 4], values[n / 2], values[(3 * n) / 4]};
}

}  // namespace lumivox
