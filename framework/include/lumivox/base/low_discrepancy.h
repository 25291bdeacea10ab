// Points that fill the unit square, or four dimensions, evenly, the same every time.
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

/// The same sequence in [0,1)^4.
inline std::array<double, 4> r4Point(int index) {
  // Reciprocal powers of the positive root of x^5 = x + 1.
  constexpr double kStep1 = 0.8566748838545029, kStep2 = 0.7338918566271260, kStep3 = 0.6287067210378087,
                   kStep4 = 0.5385972572236101;
  return {std::fmod(0.5 + kStep1 * index, 1.0), std::fmod(0.5 + kStep2 * index, 1.0),
          std::fmod(0.5 + kStep3 * index, 1.0), std::fmod(0.5 + kStep4 * index, 1.0)};
}

}  // namespace lumivox
