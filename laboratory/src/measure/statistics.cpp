// Health and repeated timings.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "lumivox/measure/metrics.h"
#include "measure/quantile.h"

namespace lumivox {

Health scanHealth(const float* values, std::size_t count, int components, bool alphaToo) {
  assert(components >= 1);
  const auto stride = static_cast<std::size_t>(components);
  constexpr std::size_t kAlpha = 3;
  // Blocks of fixed length are added in order, so that the sum does not depend on the number of threads.
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::vector<Health> blocks((count + kBlock - 1) / kBlock);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t block) {
    Health health;
    health.largest = -std::numeric_limits<double>::infinity();
    for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
      if (!alphaToo && i % stride == kAlpha) continue;
      const auto value = static_cast<double>(values[i]);
      const bool isNan = std::isnan(value), isInfinite = std::isinf(value), isNegative = value < 0.0;
      health.nan += isNan ? 1 : 0;
      health.infinite += isInfinite ? 1 : 0;
      health.negative += isNegative && !isInfinite ? 1 : 0;
      if ((isNan || isInfinite || isNegative) && health.firstBad < 0)
        health.firstBad = static_cast<std::int64_t>(i);
      if (isNan || isInfinite) continue;
      health.sum += value;
      health.largest = std::max(health.largest, value);
    }
    blocks[block] = health;
  });
  Health total;
  total.largest = -std::numeric_limits<double>::infinity();
  for (const Health& block : blocks) {
    total.nan += block.nan;
    total.infinite += block.infinite;
    total.negative += block.negative;
    if (total.firstBad < 0) total.firstBad = block.firstBad;
    total.sum += block.sum;
    total.largest = std::max(total.largest, block.largest);
  }
  if (std::isinf(total.largest)) total.largest = 0.0;  // no finite value at all
  return total;
}

TimingStatistics statisticsOf(std::vector<double> values) {
  assert(std::none_of(values.begin(), values.end(), [](double value) { return std::isnan(value); }));
  TimingStatistics result;
  if (values.empty()) return result;
  result.repeats = static_cast<int>(values.size());
  result.smallest = *std::min_element(values.begin(), values.end());
  result.lowerQuartile = quantileOf(values, 0.25);
  result.median = quantileOf(values, 0.5);
  result.upperQuartile = quantileOf(values, 0.75);
  result.largest = *std::max_element(values.begin(), values.end());
  return result;
}

Measured medianOf(const TimingStatistics& statistics) {
  constexpr double kQuartilesApart = 1.349;   // in sigmas of a normal distribution
  constexpr double kMedianOverMean = 1.2533;  // sqrt(pi/2)
  const double sigma = (statistics.upperQuartile - statistics.lowerQuartile) / kQuartilesApart;
  return {statistics.median,
          statistics.repeats > 0 ? kMedianOverMean * sigma / std::sqrt(statistics.repeats) : 0.0,
          statistics.repeats >= kLeastRepeats};
}

Measured meanOverSeeds(const std::vector<double>& values) {
  if (values.empty()) return {std::numeric_limits<double>::quiet_NaN(), 0.0};
  const auto n = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  const double mean = sum / n;
  for (const double value : values) squares += (value - mean) * (value - mean);
  // Standard error of the mean, from the unbiased variance of the values.
  return {mean, values.size() < 2 ? 0.0 : std::sqrt(squares / (n - 1.0) / n)};
}

}  // namespace lumivox
