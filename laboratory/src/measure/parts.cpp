// Bias, noise and flicker without the reference's noise, by unbiased estimates of mean squares.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"
#include "measure/pixels.h"

namespace lumivox {
namespace {

/// The root of an estimated square. Its uncertainty is the change of the root if the square grows by its
/// uncertainty u: u / (2 root) for squares well above u, and finite at 0.
Measured rootOf(double square, double uncertainty) {
  const double least = std::max(square, 0.0);
  return {std::sqrt(least), std::sqrt(least + uncertainty) - std::sqrt(least)};
}

/// Distance between pixels in the values of an image, with an alpha channel.
std::size_t stride(const ImageBuffer& image) {
  return static_cast<std::size_t>(image.channels());
}

double varianceAt(const ImageBuffer& variance, std::size_t i) {
  return variance.empty() ? 0.0 : static_cast<double>(variance.values()[i]);
}

void requireShape(const ImageBuffer& one, const ImageBuffer& other, const char* what) {
  if (!one.empty() && !one.sameShape(other))
    throw Error(fmt::format("{} has {} x {} pixels of {} channels; expected {} x {} of {}", what, one.width(),
                            one.height(), one.channels(), other.width(), other.height(), other.channels()));
}

/// Sums over the pixels that are finite in the reference and in every image.
struct Sums {
  double bias = 0.0, noise = 0.0, reference = 0.0;  ///< of the squares
  double byReference = 0.0;                         ///< variance of `bias` due to the reference's noise
  std::size_t values = 0;
};

/// Mean over the chosen seeds m, their unbiased variance s², n of them: (m - T)² has the expected value
/// bias² + s²/n + v, where v is the variance of the reference T.
Sums sumsOver(const std::vector<const ImageBuffer*>& seeds, const ImageBuffer& reference,
              const ImageBuffer& variance) {
  const auto n = static_cast<double>(seeds.size());
  const int channels = radianceChannels(reference, "a reference");
  Sums sums;
  for (std::size_t pixel = 0; pixel < reference.pixelCount(); ++pixel) {
    if (!finiteAt(reference, pixel, channels) ||
        !std::all_of(seeds.begin(), seeds.end(),
                     [&](const ImageBuffer* seed) { return finiteAt(*seed, pixel, channels); }))
      continue;
    double deviation = 0.0;  // deviation of the pixel's part of `bias`, with fully correlated channels
    for (std::size_t i = pixel * stride(reference);
         i < pixel * stride(reference) + static_cast<std::size_t>(channels); ++i) {
      double mean = 0.0, squares = 0.0;
      for (const ImageBuffer* seed : seeds) mean += static_cast<double>(seed->values()[i]) / n;
      for (const ImageBuffer* seed : seeds) {
        const double d = static_cast<double>(seed->values()[i]) - mean;
        squares += d * d;
      }
      const double own = seeds.size() > 1 ? squares / (n - 1.0) : 0.0;
      const double difference = mean - static_cast<double>(reference.values()[i]),
                   v = varianceAt(variance, i);
      sums.bias += difference * difference - own / n - v;
      sums.noise += own;
      sums.reference += v;
      // Of (b + e)² with e normal of variance v: 4 b² v + 2 v².
      deviation += std::sqrt(4.0 * difference * difference * v + 2.0 * v * v);
      ++sums.values;
    }
    sums.byReference += deviation * deviation;
  }
  return sums;
}

/// Standard deviations of the mean squares over seeds, from leaving out one seed at a time (Efron 1982, Sec.
/// 3).
std::pair<double, double> jackknife(const std::vector<const ImageBuffer*>& seeds,
                                    const ImageBuffer& reference, const ImageBuffer& variance) {
  std::vector<double> bias, noise;
  for (std::size_t left = 0; left < seeds.size(); ++left) {
    std::vector<const ImageBuffer*> others(seeds);
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left));
    const Sums sums = sumsOver(others, reference, variance);
    bias.push_back(sums.bias / static_cast<double>(sums.values));
    noise.push_back(sums.noise / static_cast<double>(sums.values));
  }
  const auto deviation = [](const std::vector<double>& values) {
    const double n = static_cast<double>(values.size()), error = meanOverSeeds(values).uncertainty;
    return (n - 1.0) * error;  // sqrt((n-1)/n sum of squares), and the error is sqrt(sum / (n-1) / n)
  };
  return {deviation(bias), deviation(noise)};
}

}  // namespace

ErrorParts errorParts(const std::vector<ImageBuffer>& seeds, const ImageBuffer& reference,
                      const ImageBuffer& referenceVariance, bool withoutNoise) {
  if (seeds.empty()) throw Error("the parts of an error need at least one image");
  requireShape(referenceVariance, reference, "the variance of a reference");
  std::vector<const ImageBuffer*> all;
  for (const ImageBuffer& seed : seeds) {
    requireShape(seed, reference, "an image");
    if (all.empty() || !withoutNoise) all.push_back(&seed);
  }
  const Sums sums = sumsOver(all, reference, referenceVariance);
  const auto values = static_cast<double>(sums.values), n = static_cast<double>(all.size());
  ErrorParts parts;
  parts.referenceNoise = std::sqrt(sums.reference / values);
  const double bias = sums.bias / values, noise = sums.noise / values;
  const double byReference = std::sqrt(sums.byReference) / values;
  if (withoutNoise) {
    parts.bias = rootOf(bias, byReference);
    parts.noise = {0.0, 0.0};
  } else if (all.size() == 2) {
    // All pixels may err together: with one degree of freedom the mean is off by s / sqrt(2).
    const double ofMean = noise / n;
    const double bySeeds = 2.0 * std::sqrt(std::max(bias, 0.0) * ofMean) + std::sqrt(2.0) * ofMean;
    parts.bias = rootOf(bias, std::hypot(byReference, bySeeds));
    parts.noise = rootOf(noise, std::sqrt(2.0) * noise);
  } else if (all.size() > 2) {
    const auto [ofBias, ofNoise] = jackknife(all, reference, referenceVariance);
    parts.bias = rootOf(bias, std::hypot(byReference, ofBias));
    parts.noise = rootOf(noise, ofNoise);
  }
  return parts;
}

Measured flicker(const std::vector<ImageBuffer>& frames, const std::vector<ImageBuffer>& references,
                 const std::vector<ImageBuffer>& variances) {
  if (frames.size() != references.size() || (!variances.empty() && variances.size() != frames.size()))
    throw Error(
        fmt::format("the flicker of {} frames needs as many references; there are {}, and {} variances",
                    frames.size(), references.size(), variances.size()));
  double square = 0.0, deviation = 0.0, pairs = 0.0;
  const ImageBuffer nothing;
  for (std::size_t f = 1; f < frames.size(); ++f, pairs += 1.0) {
    const ImageBuffer& before = variances.empty() ? nothing : variances[f - 1];
    const ImageBuffer& after = variances.empty() ? nothing : variances[f];
    // Compares the change with the true change, like any image with its reference: only the reference has
    // noise.
    ImageBuffer change = frames[f], trueChange = references[f], variance = after;
    requireShape(frames[f], references[f], "a frame");
    requireShape(frames[f - 1], references[f], "a frame");
    requireShape(references[f - 1], references[f], "the reference of a frame");
    for (std::size_t i = 0; i < change.values().size(); ++i) {
      change.values()[i] -= frames[f - 1].values()[i];
      trueChange.values()[i] -= references[f - 1].values()[i];
      if (!variance.empty()) variance.values()[i] += before.values()[i];
    }
    requireShape(variance, trueChange, "the variance of a reference");
    const Sums sums = sumsOver({&change}, trueChange, variance);
    square += sums.bias / static_cast<double>(sums.values);
    deviation += std::sqrt(sums.byReference) /
                 static_cast<double>(sums.values);  // neighbouring pairs share a reference
  }
  return pairs == 0.0 ? Measured{kNan, 0.0} : rootOf(square / pairs, deviation / pairs);
}

}  // namespace lumivox
