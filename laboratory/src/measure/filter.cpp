#include "measure/filter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace lumivox {
namespace {

/// result[x] = sum of weights[k] * sources[k][x], in the order of k. Blocks of fixed length keep the sums in
/// registers.
void sumRows(std::span<const double* const> sources, std::span<const double> weights, int width,
             double* result) {
  constexpr int kBlock = 8;
  int x = 0;
  for (; x + kBlock <= width; x += kBlock) {
    double sums[kBlock] = {};
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const double* source = sources[k] + x;
      const double weight = weights[k];
      for (int i = 0; i < kBlock; ++i) sums[i] += weight * source[i];
    }
    std::copy(sums, sums + kBlock, result + x);
  }
  for (; x < width; ++x) {
    double sum = 0.0;
    for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * sources[k][x];
    result[x] = sum;
  }
}

}  // namespace

Plane filterRows(const Plane& plane, std::span<const double> weights) {
  assert(weights.size() % 2 == 1);
  const auto radius = static_cast<std::ptrdiff_t>(weights.size() / 2);
  Plane result(plane.width, plane.height);
  tbb::parallel_for(0, plane.height, [&](int y) {
    const double* row = plane.row(y);
    std::vector<double> padded(static_cast<std::size_t>(plane.width + 2 * radius));
    std::fill_n(padded.begin(), radius, row[0]);
    std::copy_n(row, plane.width, padded.begin() + radius);
    std::fill_n(padded.end() - radius, radius, row[plane.width - 1]);
    std::vector<const double*> sources(weights.size());
    for (std::size_t k = 0; k < weights.size(); ++k) sources[k] = padded.data() + k;
    sumRows(sources, weights, plane.width, result.row(y));
  });
  return result;
}

Plane filterColumns(const Plane& plane, std::span<const double> weights) {
  assert(weights.size() % 2 == 1);
  const int radius = static_cast<int>(weights.size() / 2);
  Plane result(plane.width, plane.height);
  tbb::parallel_for(0, plane.height, [&](int y) {
    std::vector<const double*> sources(weights.size());
    for (std::size_t k = 0; k < weights.size(); ++k) {
      sources[k] = plane.row(std::clamp(y + static_cast<int>(k) - radius, 0, plane.height - 1));
    }
    sumRows(sources, weights, plane.width, result.row(y));
  });
  return result;
}

std::vector<double> gaussian(double sigma, int radius) {
  std::vector<double> weights;
  for (int x = -radius; x <= radius; ++x) weights.push_back(std::exp(-0.5 * x * x / (sigma * sigma)));
  return weights;
}

std::vector<double> normalised(std::vector<double> weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace lumivox
