// Separable filters of one-channel planes in double precision. Each result depends only on its neighbourhood,
// so it is the same for any number of threads.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lumivox {

struct Plane {
  int width = 0, height = 0;
  std::vector<double> values;  ///< row by row

  Plane() = default;
  Plane(int w, int h)
      : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  double* row(int y) { return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
  const double* row(int y) const {
    return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
};

/// Correlates with an odd number of weights centred on each pixel. The border pixel repeats beyond the
/// border.
Plane filterRows(const Plane& plane, std::span<const double> weights);
Plane filterColumns(const Plane& plane, std::span<const double> weights);

/// exp(-x^2 / (2 sigma^2)) at the whole numbers from -radius to radius, not normalised.
std::vector<double> gaussian(double sigma, int radius);
/// Scaled to the sum 1.
std::vector<double> normalised(std::vector<double> weights);

}  // namespace lumivox
