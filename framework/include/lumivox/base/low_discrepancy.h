// Points that fill the unit square, or four dimensions, evenly, the same every time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace lumivox {

/// The R2 sequence in [0,1)^2 (Roberts 2018): steps by the reciprocal powers of the plastic number, the
/// two-dimensional golden ratio. Point 0 is the centre; no two points share a row or a column.
inline std::array<double, 2> r2Point(int index) {
  constexpr double kPlastic1 = 0.7548776662466927, kPlastic2 = 0.5698402909980532;
  return {std::fmod(0.5 + kPlastic1 * index, 1.0), std::fmod(0.5 + kPlastic2 * index, 1.0)};
}

/// The same sequence in [0,1)^4.
inline std::array<double, 4> r4Point(int index) {
  // Reciprocal powers of the positive root of x^5 = x + 1.
  constexpr double kStep1 = 0.8566748838545029, kStep2 = 0.7338918566271260, kStep3 = 0.6287067210378087,
                   kStep4 = 0.5385972572236101;
  return {std::fmod(0.5 + kStep1 * index, 1.0), std::fmod(0.5 + kStep2 * index, 1.0),
          std::fmod(0.5 + kStep3 * index, 1.0), std::fmod(0.5 + kStep4 * index, 1.0)};
}

/// `count` points in (0,1)^2 that are as many different, evenly spaced rows and columns: the rank-1 lattice
/// whose nearest points lie furthest apart (Dammertz and Keller 2008). A straight edge along the rows or
/// columns covers the same share of them as of the square within 1 / (2 count), which no sequence can promise
/// for its first few points. One point is the centre.
inline std::vector<std::array<double, 2>> latticePoints(int count) {
  const auto wrapped = [&](int value) { return std::min(value, count - value); };
  int step = 1;
  long best = -1;
  for (int candidate = 1; candidate < count; ++candidate) {
    if (std::gcd(candidate, count) != 1) continue;
    long nearest = std::numeric_limits<long>::max();  // squared, in units of 1 / count
    for (int i = 1; i < count && nearest > best; ++i) {
      const long x = wrapped(i), y = wrapped(static_cast<int>(long{i} * candidate % count));
      nearest = std::min(nearest, x * x + y * y);
    }
    if (nearest <= best) continue;
    best = nearest;
    step = candidate;
  }
  std::vector<std::array<double, 2>> points;
  for (int i = 0; i < count; ++i)
    points.push_back({(i + 0.5) / count, (static_cast<double>(long{i} * step % count) + 0.5) / count});
  return points;
}

}  // namespace lumivox
