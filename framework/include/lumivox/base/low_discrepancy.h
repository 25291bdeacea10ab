// Points that fill the unit square evenly, the same every time.
#pragma once

#include <array>
#include <cmath>

namespace lumivox {

/// The R2 sequence in [0,1)^2 (Roberts 2018): steps by the reciprocal powers of the plastic number, the
/// two-dimensional golden ratio. Point 0 is the centre; no two points share a row or a column.
inline std::array<double, 2> r2Point(int index) {
  constexpr double kPlastic1 = 0.7548776662466927, kPlastic2 = 0.5698402909980532;
  return {std::fmod(0.5 + kPlastic1 * index, 1.0), std::fmod(0.5 + kPlastic2 * index, 1.0)};
}

}  // namespace lumivox
