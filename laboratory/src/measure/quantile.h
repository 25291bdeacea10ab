// Quantiles with linear interpolation between the order statistics: of n sorted values, the quantile q lies
// at place q (n - 1).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lumivox {

/// NaN without values. Reorders the values.
template <class Value>
double quantileOf(std::vector<Value>& values, double quantile) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = quantile * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), values.begin() + below, values.end());
  const auto lower = static_cast<double>(values[static_cast<std::size_t>(below)]);
  const double fraction = place - static_cast<double>(below);
  if (fraction == 0.0) return lower;
  const auto upper = static_cast<double>(*std::min_element(values.begin() + below + 1, values.end()));
  return lower + fraction * (upper - lower);
}

}  // namespace lumivox
