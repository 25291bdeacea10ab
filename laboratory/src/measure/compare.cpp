// The errors of an image against its reference, and how far the reference's own noise may have moved them.
//
// Propagation to first order. A metric f of the reference's values t_i, each with the variance v_i, has the
// variance
//   Var f = sum over pixels of Var(sum over the pixel's channels of g_i n_i),   g_i = df/dt_i,
// because pixels are sampled independently. The channels of one pixel are not: the same light paths fill all
// of them. Their covariance is not recorded, so the bound for full correlation is taken, which is exact for
// grey light and never too small:
//   Var f <= sum over pixels of (sum over channels of |g_i| sqrt(v_i))^2.
// With d_i = x_i - t_i, N values, M = mean d^2:
//   RMSE = sqrt(M)           g_i = -d_i / (N RMSE)
//   relative MSE             g_i = -(2 / N) (d_i / q_i + d_i^2 t_i / q_i^2) - (2 e 0.01 / N) mean(d^2 / q^2),
//                            q_i = t_i^2 + e^2, e = 0.01 mean(t); the last term is the reference's share in e
//   mean ratio = X / T       g_i = -X / T^2
//   bias = mean d            g_i = -1 / N
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "lumivox/base/error.h"
#include "lumivox/base/random.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/measure/metrics.h"
#include "measure/pixels.h"
#include "measure/quantile.h"

namespace lumivox {
namespace {

/// Sums of one kind of term over all pixels that count. Rows are summed in parallel and then added from the
/// top, so that the result does not depend on the number of threads. `addPixel(pixel, sums)` adds one pixel's
/// terms.
template <std::size_t count, class AddPixel>
std::array<double, count> sumPixels(const ComparablePair& pair, const AddPixel& addPixel) {
  const auto width = static_cast<std::size_t>(pair.reference.width());
  std::vector<std::array<double, count>> rows(static_cast<std::size_t>(pair.reference.height()));
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t y) {
    std::array<double, count> sums{};
    for (std::size_t pixel = y * width; pixel < (y + 1) * width; ++pixel) {
      if (pair.counts[pixel] != 0) addPixel(pixel, sums);
    }
    rows[y] = sums;
  });
  std::array<double, count> total{};
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < count; ++i) total[i] += row[i];
  }
  return total;
}

/// The deviations sqrt(v) of the reference's values, in the channels of the pair; empty when no variance is
/// known.
ImageBuffer deviationsOf(const ImageBuffer& variance, const ImageBuffer& reference,
                         const ComparablePair& pair) {
  if (variance.empty()) return {};
  if (!variance.sameShape(reference)) {
    throw Error(fmt::format(
        "the reference's variance is {} x {} pixels with {} channels; expected the reference's {} x {} with {}",
        variance.width(), variance.height(), variance.channels(), reference.width(), reference.height(),
        reference.channels()));
  }
  ImageBuffer deviations(reference.width(), reference.height(), pair.reference.channels());
  for (int y = 0; y < reference.height(); ++y) {
    for (int x = 0; x < reference.width(); ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(reference.width()) +
                                static_cast<std::size_t>(x);
      if (pair.counts[pixel] == 0) continue;
      for (int c = 0; c < deviations.channels(); ++c) {
        const float value = variance.at(x, y, c);
        if (!(value >= 0.0f) || !std::isfinite(value)) {
          throw Error(fmt::format(
              "the reference's variance is {} at pixel {}, {}; expected a finite number of at least 0", value,
              x, y));
        }
        deviations.at(x, y, c) = std::sqrt(value);
      }
    }
  }
  return deviations;
}

/// The metrics that are sums over pixels, with their uncertainties.
void compareValues(const ComparablePair& pair, const ImageBuffer& deviations, ImageError& result) {
  const auto channels = static_cast<std::size_t>(pair.reference.channels());
  const auto& x = pair.image.values();
  const auto& t = pair.reference.values();
  const auto& s = deviations.values();
  const auto forChannels = [&](std::size_t pixel, auto&& visit) {
    for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i)
      visit(i, double{x[i]} - double{t[i]}, double{t[i]});
  };

  enum { pixels, sumImage, sumReference, sumSquares, sumVariance, firstCount };
  const auto first = sumPixels<firstCount>(pair, [&](std::size_t pixel, auto& sums) {
    sums[pixels] += 1.0;
    forChannels(pixel, [&](std::size_t i, double d, double reference) {
      sums[sumImage] += double{x[i]};
      sums[sumReference] += reference;
      sums[sumSquares] += d * d;
      if (!s.empty()) sums[sumVariance] += double{s[i]} * double{s[i]};
    });
  });
  const double n = first[pixels] * static_cast<double>(channels);
  const double meanReference = first[sumReference] / n;
  const double epsilon = 0.01 * meanReference;
  result.rmse.value = std::sqrt(first[sumSquares] / n);
  result.bias.value = (first[sumImage] - first[sumReference]) / n;
  result.meanRatio.value = first[sumReference] != 0.0 ? first[sumImage] / first[sumReference] : kNan;
  result.noiseFloor = std::sqrt(first[sumVariance] / n);

  enum { relative, epsilonSlope, secondCount };
  const auto second = sumPixels<secondCount>(pair, [&](std::size_t pixel, auto& sums) {
    forChannels(pixel, [&](std::size_t, double d, double reference) {
      const double q = reference * reference + epsilon * epsilon;
      sums[relative] += d * d / q;
      sums[epsilonSlope] += d * d / (q * q);
    });
  });
  result.relativeMse.value = epsilon != 0.0 ? second[relative] / n : kNan;
  if (s.empty()) return;

  enum { ofRmse, ofRelative, ofSum, thirdCount };
  const double throughEpsilon = -2.0 * epsilon * 0.01 / n * second[epsilonSlope] / n;
  const auto third = sumPixels<thirdCount>(pair, [&](std::size_t pixel, auto& sums) {
    double rmse = 0.0, relativeMse = 0.0, sum = 0.0;
    forChannels(pixel, [&](std::size_t i, double d, double reference) {
      const double q = reference * reference + epsilon * epsilon;
      rmse += std::abs(d) * double{s[i]};
      relativeMse +=
          std::abs(-2.0 / n * (d / q + d * d * reference / (q * q)) + throughEpsilon) * double{s[i]};
      sum += double{s[i]};
    });
    sums[ofRmse] += rmse * rmse;
    sums[ofRelative] += relativeMse * relativeMse;
    sums[ofSum] += sum * sum;
  });
  // Without any difference the derivative of the root is undefined; the noise floor is then the uncertainty
  // of the RMSE.
  result.rmse.uncertainty =
      result.rmse.value > 0.0 ? std::sqrt(third[ofRmse]) / (n * result.rmse.value) : result.noiseFloor;
  result.relativeMse.uncertainty = epsilon != 0.0 ? std::sqrt(third[ofRelative]) : kNan;
  result.meanRatio.uncertainty =
      std::abs(result.meanRatio.value / first[sumReference]) * std::sqrt(third[ofSum]);
  result.bias.uncertainty = std::sqrt(third[ofSum]) / n;
}

/// The metrics that have no simple derivative.
struct Perceived {
  double percentile95 = 0.0, ssim = 0.0, flip = 0.0, flipLdr = 0.0;
};

/// sRGB-encoded luminance in [0,1] as a display shows it, which SSIM is defined for.
ImageBuffer displayed(const ImageBuffer& image, float exposure) {
  ImageBuffer result = luminance(image);
  for (float& value : result.values()) value = linearToSrgb(std::clamp(value * exposure, 0.0f, 1.0f));
  return result;
}

ImageBuffer scaled(ImageBuffer image, float factor) {
  for (float& value : image.values()) value *= factor;
  return image;
}

/// FLIP maps of one pair.
struct FlipPair {
  const ImageBuffer &hdr, &ldr;
};

Perceived perceivedDifference(const ComparablePair& pair, const ImageBuffer& reference, float exposure,
                              const FlipPair& flip) {
  std::vector<double> differences;
  for (std::size_t pixel = 0; pixel < pair.counts.size(); ++pixel) {
    if (pair.counts[pixel] != 0)
      differences.push_back(std::abs(luminanceAt(pair.image, pixel) - luminanceAt(reference, pixel)));
  }
  const auto meanOf = [&](const ImageBuffer& map, bool windowsInside) {
    enum { sum, count, sums };
    const auto width = static_cast<std::size_t>(map.width());
    const auto total = sumPixels<sums>(pair, [&](std::size_t pixel, auto& into) {
      if (windowsInside && !ssimCounts(map, static_cast<int>(pixel % width), static_cast<int>(pixel / width)))
        return;
      into[sum] += double{map.values()[pixel]};
      into[count] += 1.0;
    });
    return total[sum] / total[count];
  };
  Perceived result;
  result.percentile95 = quantileOf(differences, 0.95);
  result.ssim = meanOf(ssimMap(displayed(pair.image, exposure), displayed(reference, exposure)), true);
  result.flip = meanOf(flip.hdr, false);
  result.flipLdr = meanOf(flip.ldr, false);
  return result;
}

/// The reference with twice the noise variance: another draw of its noise is added, the same in all channels
/// of a pixel (see above).
ImageBuffer withNoiseDoubled(const ImageBuffer& reference, const ImageBuffer& deviations) {
  constexpr std::uint64_t kSeed = 0x6c756d69766f78;  // any fixed number, so that the result is repeatable
  ImageBuffer noisy = reference;
  const auto channels = static_cast<std::size_t>(reference.channels());
  tbb::parallel_for(std::size_t{0}, reference.pixelCount(), [&](std::size_t pixel) {
    RandomStream random(kSeed, static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(pixel >> 32));
    // Box and Muller 1958: a standard normal number from two uniform ones.
    const double radius = std::sqrt(-2.0 * std::log(1.0 - double{random.uniform()}));
    const double normal = radius * std::cos(2.0 * std::numbers::pi * double{random.uniform()});
    for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
      noisy.values()[i] += static_cast<float>(normal * double{deviations.values()[i]});
    }
  });
  return noisy;
}

/// Estimates the effect of the reference's noise on metrics without a simple derivative: doubling the noise
/// moves them about as far as the present noise did.
void addPerceived(ImageError& result, const Perceived& measured, const Perceived* moved) {
  result.percentile95 = measured.percentile95;
  result.ssim = measured.ssim;
  result.flip = measured.flip;
  result.flipLdr = measured.flipLdr;
  if (moved == nullptr) return;
  result.percentile95Uncertainty = std::abs(moved->percentile95 - measured.percentile95);
  result.ssimUncertainty = std::abs(moved->ssim - measured.ssim);
  result.flipUncertainty = std::abs(moved->flip - measured.flip);
  result.flipLdrUncertainty = std::abs(moved->flipLdr - measured.flipLdr);
}

/// Mean over the images. The uncertainty is that of the reference's noise plus the spread of the images.
ImageError meanOver(const std::vector<ImageError>& each) {
  ImageError mean = each.front();
  const auto merge = [&](double& value, double& uncertainty, const auto& numberOf) {
    std::vector<double> values;
    for (const ImageError& one : each) values.push_back(numberOf(one));
    const Measured over = meanOverSeeds(values);
    value = over.value;
    uncertainty = std::hypot(uncertainty, over.uncertainty);
  };
  const auto measured = [&](Measured ImageError::*number) {
    merge((mean.*number).value, (mean.*number).uncertainty,
          [&](const ImageError& one) { return (one.*number).value; });
  };
  const auto plain = [&](double ImageError::*number, double ImageError::*uncertainty) {
    merge(mean.*number, mean.*uncertainty, [&](const ImageError& one) { return one.*number; });
  };
  measured(&ImageError::rmse);
  measured(&ImageError::relativeMse);
  measured(&ImageError::meanRatio);
  measured(&ImageError::bias);
  plain(&ImageError::percentile95, &ImageError::percentile95Uncertainty);
  plain(&ImageError::ssim, &ImageError::ssimUncertainty);
  plain(&ImageError::flip, &ImageError::flipUncertainty);
  plain(&ImageError::flipLdr, &ImageError::flipLdrUncertainty);
  for (const ImageError& one : each) mean.nonFiniteImage = std::max(mean.nonFiniteImage, one.nonFiniteImage);
  return mean;
}

std::vector<const ImageBuffer*> pointersTo(const std::vector<ImageBuffer>& images) {
  std::vector<const ImageBuffer*> pointers;
  for (const ImageBuffer& image : images) pointers.push_back(&image);
  return pointers;
}

}  // namespace

SeedsError compareSeeds(std::span<const ImageBuffer> seeds, const ImageBuffer& reference,
                        const ImageBuffer& referenceVariance, std::optional<double> givenExposure) {
  const std::vector<ComparablePair> pairs = comparable(seeds, reference);
  const ImageBuffer& expected = pairs.front().reference;
  const ImageBuffer deviations = deviationsOf(referenceVariance, reference, pairs.front());
  Display display;
  display.exposure = givenExposure.value_or(displayExposure(reference));
  const float exposure = display.factor();
  const bool noisy = !deviations.empty();
  const ImageBuffer other = noisy ? withNoiseDoubled(expected, deviations) : ImageBuffer();
  const ImageBuffer shownOther = scaled(other, exposure);

  std::vector<ImageBuffer> shown;
  std::vector<const ImageBuffer*> images;
  for (const ComparablePair& pair : pairs) {
    images.push_back(&pair.image);
    shown.push_back(scaled(pair.image, exposure));
  }
  FlipMaps hdr = flipHdrMaps(images, expected, noisy ? &other : nullptr, kDefaultPixelsPerDegree,
                             flipExposures(expected));
  const FlipMaps ldr = flipLdrMaps(pointersTo(shown), scaled(expected, exposure),
                                   noisy ? &shownOther : nullptr, kDefaultPixelsPerDegree);

  SeedsError result;
  std::vector<ImageError> each;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    ImageError& one = each.emplace_back();
    one.nonFiniteImage = pairs[i].nonFiniteImage;
    one.nonFiniteReference = pairs[i].nonFiniteReference;
    one.exposure = display.exposure;
    compareValues(pairs[i], deviations, one);
    const Perceived measured =
        perceivedDifference(pairs[i], expected, exposure, {hdr.ofImages[i], ldr.ofImages[i]});
    const bool first = i == 0 && noisy;
    const Perceived moved =
        first ? perceivedDifference(pairs[i], other, exposure, {hdr.againstOther, ldr.againstOther})
              : Perceived{};
    addPerceived(one, measured, first ? &moved : nullptr);
  }
  result.mean = meanOver(each);
  result.flipMap = withBadPixelsMarked(std::move(hdr.ofImages.front()), pairs.front().counts);
  return result;
}

ImageError compare(const ImageBuffer& image, const ImageBuffer& reference,
                   const ImageBuffer& referenceVariance, std::optional<double> exposure) {
  return compareSeeds(std::span(&image, 1), reference, referenceVariance, exposure).mean;
}

double flicker(const ImageBuffer& frame0, const ImageBuffer& frame1, const ImageBuffer& reference0,
               const ImageBuffer& reference1) {
  const ComparablePair before = comparable(frame0, reference0);
  const ComparablePair after = comparable(frame1, reference1);
  if (!before.reference.sameShape(after.reference))
    throw Error("consecutive frames of different shapes cannot be compared");
  const auto channels = static_cast<std::size_t>(before.reference.channels());
  enum { sumSquares, values, count };
  const auto total = sumPixels<count>(before, [&](std::size_t pixel, auto& sums) {
    if (after.counts[pixel] == 0) return;
    for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
      const double change = double{after.image.values()[i]} - double{before.image.values()[i]};
      const double trueChange = double{after.reference.values()[i]} - double{before.reference.values()[i]};
      sums[sumSquares] += (change - trueChange) * (change - trueChange);
      sums[values] += 1.0;
    }
  });
  return std::sqrt(total[sumSquares] / total[values]);
}

}  // namespace lumivox
