// FLIP: how visible the difference is to a person who flips between two images.
// Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild 2020, "FLIP: A Difference Evaluator for
// Alternating Images", and Andersson, Nilsson, Shirley, Akenine-Moeller 2021, "Visualizing Errors in Rendered
// High Dynamic Range Images" (HDR-FLIP).
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"
#include "measure/filter.h"
#include "measure/pixels.h"
#include "measure/quantile.h"

namespace lumivox {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

constexpr double kPi = std::numbers::pi;

// ---- the spaces of colour vision

/// Linear Rec. 709 R, G, B to CIE XYZ, from the chromaticities of the primaries and of the white of FLIP's
/// definition (D65 with five digits); R = G = B = 1 is white with Y = 1.
struct ColourSpace {
  dmat3 xyzFromRgb, rgbFromXyz;
  dvec3 white;

  ColourSpace() {
    const auto xyzOf = [](double x, double y) { return dvec3(x / y, 1.0, (1.0 - x - y) / y); };
    white = xyzOf(0.31271, 0.32902);
    const dmat3 primaries(xyzOf(0.64, 0.33), xyzOf(0.30, 0.60), xyzOf(0.15, 0.06));
    const dvec3 scale = glm::inverse(primaries) * white;
    xyzFromRgb = dmat3(primaries[0] * scale.x, primaries[1] * scale.y, primaries[2] * scale.z);
    rgbFromXyz = glm::inverse(xyzFromRgb);
  }
};

const ColourSpace kSpace;

/// The linearised CIELab of Sec. 4.1: achromatic Y, red-green Cx, blue-yellow Cz.
dvec3 opponentFromRgb(const dvec3& rgb) {
  const dvec3 relative = (kSpace.xyzFromRgb * rgb) / kSpace.white;
  return {116.0 * relative.y - 16.0, 500.0 * (relative.x - relative.y), 200.0 * (relative.y - relative.z)};
}

dvec3 rgbFromOpponent(const dvec3& opponent) {
  const double y = (opponent.x + 16.0) / 116.0;
  return kSpace.rgbFromXyz * (dvec3(y + opponent.y / 500.0, y, y - opponent.z / 200.0) * kSpace.white);
}

/// CIE 1976 L*a*b*, then Hunt's adjustment (Sec. 4.1, Eq. 4): saturation shows less in the dark.
dvec3 huntLabFromRgb(const dvec3& rgb) {
  constexpr double kDelta = 6.0 / 29.0;  // CIE 15: where the cube root changes to its tangent
  const dvec3 relative = (kSpace.xyzFromRgb * rgb) / kSpace.white;
  const auto root = [](double t) {
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
  };
  const dvec3 f(root(relative.x), root(relative.y), root(relative.z));
  const double lightness = 116.0 * f.y - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (f.x - f.y), 0.01 * lightness * 200.0 * (f.y - f.z)};
}

/// HyAB distance (Eq. 5): lightness and chroma apart, for large differences.
double hyab(const dvec3& a, const dvec3& b) {
  return std::abs(a.x - b.x) + glm::length(dvec2(a.y - b.y, a.z - b.z));
}

// ---- filters

/// One Gaussian of a contrast sensitivity function, a sqrt(pi / b) exp(-pi^2 r^2 / b), r in degrees
/// (Sec. 4.1, Eq. 2 and Table 1).
struct Sensitivity {
  double a, b;
};
constexpr Sensitivity kAchromatic{1.0, 0.0047}, kRedGreen{1.0, 0.0053}, kBlueYellowWide{34.1, 0.04},
    kBlueYellowNarrow{13.5, 0.025};

struct Filters {
  std::vector<double> achromatic, redGreen, blueYellowWide,
      blueYellowNarrow;    ///< along one axis, each of sum 1
  double wideShare = 0.0;  ///< weight of the wide Gaussian in blue-yellow
  std::vector<double> blur, edge,
      point;  ///< filters of the features: along the other axis, first and second derivative

  explicit Filters(double pixelsPerDegree) {
    // Three standard deviations of the widest Gaussian; exp(-pi^2 r^2 / b) has the deviation sqrt(b / (2
    // pi^2)) degrees.
    const auto deviation = [&](double b) { return std::sqrt(b / (2.0 * kPi * kPi)) * pixelsPerDegree; };
    const int radius = static_cast<int>(std::ceil(3.0 * deviation(kBlueYellowWide.b)));
    achromatic = normalised(gaussian(deviation(kAchromatic.b), radius));
    redGreen = normalised(gaussian(deviation(kRedGreen.b), radius));
    // The sum of two Gaussians is not separable, but each of them is. The two-dimensional sum of all weights
    // is scaled to 1.
    const auto weightOf = [&](const Sensitivity& s) {
      double sum = 0.0;
      for (const double weight : gaussian(deviation(s.b), radius)) sum += weight;
      return s.a * std::sqrt(kPi / s.b) * sum * sum;
    };
    wideShare = weightOf(kBlueYellowWide) / (weightOf(kBlueYellowWide) + weightOf(kBlueYellowNarrow));
    blueYellowWide = normalised(gaussian(deviation(kBlueYellowWide.b), radius));
    blueYellowNarrow = normalised(gaussian(deviation(kBlueYellowNarrow.b), radius));

    // Sec. 4.2: derivatives of a Gaussian whose width is that of the eye's edge detector, 0.082 degrees from
    // trough to peak.
    constexpr double kPeakToTrough = 0.082;
    const double sigma = 0.5 * kPeakToTrough * pixelsPerDegree;
    const int featureRadius = static_cast<int>(std::ceil(3.0 * sigma));
    blur = normalised(gaussian(sigma, featureRadius));
    edge = point = gaussian(sigma, featureRadius);
    for (int x = -featureRadius; x <= featureRadius; ++x) {
      edge[static_cast<std::size_t>(x + featureRadius)] *= -x;
      point[static_cast<std::size_t>(x + featureRadius)] *= x * x / (sigma * sigma) - 1.0;
    }
    balance(edge);
    balance(point);
  }

 private:
  /// Scales the positive weights to the sum 1 and the negative ones to -1, so that a constant image has no
  /// features.
  static void balance(std::vector<double>& weights) {
    double positive = 0.0, negative = 0.0;
    for (const double weight : weights) (weight > 0.0 ? positive : negative) += std::abs(weight);
    for (double& weight : weights) weight /= weight > 0.0 ? positive : negative;
  }
};

// ---- the two pipelines

/// The data of one image that FLIP compares.
struct Percept {
  std::vector<dvec3> lab;  ///< filtered by contrast sensitivity, Hunt-adjusted
  Plane edges, points;     ///< strength of the features
};

Plane strength(const Plane& alongRows, const Plane& alongColumns) {
  Plane result(alongRows.width, alongRows.height);
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    result.values[i] = std::sqrt(alongRows.values[i] * alongRows.values[i] +
                                 alongColumns.values[i] * alongColumns.values[i]);
  }
  return result;
}

/// `rgb` gives the linear R, G, B in [0,1] of a pixel.
template <class Rgb>
Percept perceive(int width, int height, const Filters& filters, const Rgb& rgb) {
  std::array<Plane, 3> opponent{Plane(width, height), Plane(width, height), Plane(width, height)};
  Plane normalisedLuminance(width, height);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      const dvec3 value = opponentFromRgb(rgb(pixel));
      for (int c = 0; c < 3; ++c) opponent[static_cast<std::size_t>(c)].values[pixel] = value[c];
      normalisedLuminance.values[pixel] = (value.x + 16.0) / 116.0;
    }
  });
  const auto blurred = [](const Plane& plane, const std::vector<double>& weights) {
    return filterColumns(filterRows(plane, weights), weights);
  };
  Percept percept;
  {
    const Plane achromatic = blurred(opponent[0], filters.achromatic);
    const Plane redGreen = blurred(opponent[1], filters.redGreen);
    const Plane wide = blurred(opponent[2], filters.blueYellowWide);
    const Plane narrow = blurred(opponent[2], filters.blueYellowNarrow);
    percept.lab.resize(achromatic.values.size());
    tbb::parallel_for(0, height, [&](int y) {
      const std::size_t begin = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
      for (std::size_t i = begin; i < begin + static_cast<std::size_t>(width); ++i) {
        const double blueYellow =
            filters.wideShare * wide.values[i] + (1.0 - filters.wideShare) * narrow.values[i];
        // Colours beyond the display's gamut are clipped before the distance is taken.
        const dvec3 shown = rgbFromOpponent({achromatic.values[i], redGreen.values[i], blueYellow});
        percept.lab[i] = huntLabFromRgb(glm::clamp(shown, 0.0, 1.0));
      }
    });
  }
  const Plane blurredDown = filterColumns(normalisedLuminance, filters.blur);
  const Plane blurredAcross = filterRows(normalisedLuminance, filters.blur);
  percept.edges = strength(filterRows(blurredDown, filters.edge), filterColumns(blurredAcross, filters.edge));
  percept.points =
      strength(filterRows(blurredDown, filters.point), filterColumns(blurredAcross, filters.point));
  return percept;
}

/// Sec. 4.1, Eq. 6 and Sec. 4.2-4.3, Eqs. 7-9: both differences in [0,1], the colour difference raised by
/// that of the features.
double flipOf(const Percept& image, const Percept& reference, std::size_t pixel) {
  constexpr double kColourExponent = 0.7, kFeatureExponent = 0.5;  // q_c, q_f
  constexpr double kKnee = 0.4, kKneeValue = 0.95;                 // p_c, p_t
  // The largest distance between two colours of the display is that between green and blue.
  static const double largest =
      std::pow(hyab(huntLabFromRgb({0.0, 1.0, 0.0}), huntLabFromRgb({0.0, 0.0, 1.0})), kColourExponent);
  const double distance = std::pow(hyab(image.lab[pixel], reference.lab[pixel]), kColourExponent);
  const double knee = kKnee * largest;
  const double colour = distance < knee
                            ? distance * kKneeValue / knee
                            : kKneeValue + (distance - knee) / (largest - knee) * (1.0 - kKneeValue);
  const double edges = std::abs(image.edges.values[pixel] - reference.edges.values[pixel]);
  const double points = std::abs(image.points.values[pixel] - reference.points.values[pixel]);
  const double feature = std::pow(std::max(edges, points) / std::numbers::sqrt2, kFeatureExponent);
  return std::clamp(std::pow(colour, 1.0 - feature), 0.0, 1.0);
}

/// The percept of an image on the display.
template <class Tone>
Percept perceiveWith(const ImageBuffer& source, const Filters& filters, const Tone& tone) {
  const auto channels = static_cast<std::size_t>(source.channels());
  return perceive(source.width(), source.height(), filters, [&](std::size_t pixel) {
    const float* values = source.values().data() + pixel * channels;
    if (channels == 1) return dvec3(tone(values[0]));
    return dvec3(tone(values[0]), tone(values[1]), tone(values[2]));
  });
}

/// Raises each pixel of a map to the difference of the percepts where that is larger.
void raise(ImageBuffer& map, const Percept& seen, const Percept& expected) {
  const auto width = static_cast<std::size_t>(map.width());
  tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(map.height()), [&](std::size_t y) {
    for (std::size_t pixel = y * width; pixel < (y + 1) * width; ++pixel)
      map.values()[pixel] = std::max(map.values()[pixel], static_cast<float>(flipOf(seen, expected, pixel)));
  });
}

template <class Tone>
void raiseMaps(FlipMaps& maps, std::span<const ImageBuffer* const> images, const ImageBuffer& reference,
               const ImageBuffer* other, const Filters& filters, const Tone& tone) {
  const Percept expected = perceiveWith(reference, filters, tone);
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Percept seen = perceiveWith(*images[i], filters, tone);
    raise(maps.ofImages[i], seen, expected);
    if (i == 0 && other != nullptr) raise(maps.againstOther, seen, perceiveWith(*other, filters, tone));
  }
}

FlipMaps blankMaps(std::span<const ImageBuffer* const> images, const ImageBuffer& reference,
                   const ImageBuffer* other) {
  FlipMaps maps;
  maps.ofImages.assign(images.size(), ImageBuffer(reference.width(), reference.height(), 1));
  if (other != nullptr) maps.againstOther = ImageBuffer(reference.width(), reference.height(), 1);
  return maps;
}

void requireViewing(double pixelsPerDegree) {
  if (!(pixelsPerDegree > 0.0) ||
      pixelsPerDegree > 1e4) {  // above this, kernels are thousands of pixels wide
    throw Error(fmt::format(
        "FLIP cannot be taken at {} pixels per degree; expected above 0 and at most 10000", pixelsPerDegree));
  }
}

}  // namespace

ImageBuffer withBadPixelsMarked(ImageBuffer map, const std::vector<unsigned char>& counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) map.values()[i] = std::numeric_limits<float>::quiet_NaN();
  }
  return map;
}

std::vector<double> flipExposures(const ImageBuffer& reference) {
  // The shortest exposure maps the brightest luminance, the longest the median one, to 0.85 of the display's
  // white.
  constexpr double kTarget = 0.85;
  std::vector<double> luminances(reference.pixelCount());
  for (std::size_t pixel = 0; pixel < luminances.size(); ++pixel)
    luminances[pixel] = std::max(0.0, luminanceAt(reference, pixel));
  const double largest = *std::max_element(luminances.begin(), luminances.end());
  constexpr std::size_t kFewest = 2;
  if (largest <= 0.0) return std::vector<double>(kFewest, 0.0);
  double median = quantileOf(luminances, 0.5);
  if (median <= 0.0) {
    // Deviates: a reference that is black in more than half of its pixels has no finite longest exposure; its
    // lit pixels decide.
    luminances.erase(std::remove(luminances.begin(), luminances.end(), 0.0), luminances.end());
    median = quantileOf(luminances, 0.5);
  }
  const double start = std::log2(FilmicCurve::inverse(kTarget) / largest);
  const double stop = std::log2(FilmicCurve::inverse(kTarget) / median);
  const std::size_t count = std::max(kFewest, static_cast<std::size_t>(std::ceil(stop - start)));
  std::vector<double> stops(count);
  for (std::size_t i = 0; i < count; ++i) {
    stops[i] = start + (stop - start) * static_cast<double>(i) / static_cast<double>(count - 1);
  }
  return stops;
}

FlipMaps flipLdrMaps(std::span<const ImageBuffer* const> images, const ImageBuffer& reference,
                     const ImageBuffer* other, double pixelsPerDegree) {
  const auto clip = [](float value) { return std::clamp(static_cast<double>(value), 0.0, 1.0); };
  FlipMaps maps = blankMaps(images, reference, other);
  raiseMaps(maps, images, reference, other, Filters(pixelsPerDegree), clip);
  return maps;
}

FlipMaps flipHdrMaps(std::span<const ImageBuffer* const> images, const ImageBuffer& reference,
                     const ImageBuffer* other, double pixelsPerDegree, const std::vector<double>& stops) {
  const Filters filters(pixelsPerDegree);
  FlipMaps maps = blankMaps(images, reference, other);
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (i > 0 && stops[i] == stops[i - 1]) continue;
    const double exposure = std::exp2(stops[i]);
    raiseMaps(maps, images, reference, other, filters,
              [&](float value) { return FilmicCurve::apply(exposure * value); });
  }
  return maps;
}

ImageBuffer flipLdrOf(const ImageBuffer& image, const ImageBuffer& reference, double pixelsPerDegree) {
  const ImageBuffer* const one[] = {&image};
  return std::move(flipLdrMaps(one, reference, nullptr, pixelsPerDegree).ofImages.front());
}

ImageBuffer flipHdrOf(const ImageBuffer& image, const ImageBuffer& reference, double pixelsPerDegree,
                      const std::vector<double>& stops) {
  const ImageBuffer* const one[] = {&image};
  return std::move(flipHdrMaps(one, reference, nullptr, pixelsPerDegree, stops).ofImages.front());
}

ImageBuffer flipLdr(const ImageBuffer& linearImage, const ImageBuffer& linearReference,
                    double pixelsPerDegree) {
  requireViewing(pixelsPerDegree);
  const ComparablePair pair = comparable(linearImage, linearReference);
  return withBadPixelsMarked(flipLdrOf(pair.image, pair.reference, pixelsPerDegree), pair.counts);
}

ImageBuffer flipHdr(const ImageBuffer& linearImage, const ImageBuffer& linearReference,
                    double pixelsPerDegree) {
  requireViewing(pixelsPerDegree);
  const ComparablePair pair = comparable(linearImage, linearReference);
  return withBadPixelsMarked(
      flipHdrOf(pair.image, pair.reference, pixelsPerDegree, flipExposures(pair.reference)), pair.counts);
}

}  // namespace lumivox
