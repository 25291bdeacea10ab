// Structural similarity: Wang, Bovik, Sheikh, Simoncelli 2004, "Image Quality Assessment: From Error
// Visibility to Structural Similarity".
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"
#include "measure/filter.h"
#include "measure/pixels.h"

namespace lumivox {
namespace {

// Sec. III-C: a Gaussian window of 11 x 11 pixels and 1.5 pixels of deviation; K1, K2; the range of values L
// is 1 here.
constexpr int kWindowRadius = 5;
constexpr double kWindowSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;

}  // namespace

bool ssimCounts(const ImageBuffer& image, int x, int y) {
  const auto inside = [](int place, int size) {
    return size <= 2 * kWindowRadius || (place >= kWindowRadius && place < size - kWindowRadius);
  };
  return inside(x, image.width()) && inside(y, image.height());
}

ImageBuffer ssimMap(const ImageBuffer& imageLuminance, const ImageBuffer& referenceLuminance) {
  const int width = referenceLuminance.width(), height = referenceLuminance.height();
  const auto window = normalised(gaussian(kWindowSigma, kWindowRadius));
  const auto mean = [&](auto&& valueOf) {
    Plane plane(width, height);
    for (std::size_t i = 0; i < plane.values.size(); ++i) {
      plane.values[i] = valueOf(double{imageLuminance.values()[i]}, double{referenceLuminance.values()[i]});
    }
    return filterColumns(filterRows(plane, window), window);
  };
  const Plane x = mean([](double a, double) { return a; }), y = mean([](double, double b) { return b; });
  const Plane xx = mean([](double a, double) { return a * a; }),
              yy = mean([](double, double b) { return b * b; });
  const Plane xy = mean([](double a, double b) { return a * b; });
  ImageBuffer map(width, height, 1);
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    const double meanX = x.values[i], meanY = y.values[i];
    const double varianceX = xx.values[i] - meanX * meanX, varianceY = yy.values[i] - meanY * meanY;
    const double covariance = xy.values[i] - meanX * meanY;
    // Eq. 13.
    map.values()[i] =
        static_cast<float>((2.0 * meanX * meanY + kC1) * (2.0 * covariance + kC2) /
                           ((meanX * meanX + meanY * meanY + kC1) * (varianceX + varianceY + kC2)));
  }
  return map;
}

double ssim(const ImageBuffer& imageLuminance, const ImageBuffer& referenceLuminance) {
  if (imageLuminance.channels() != 1) {
    throw Error(fmt::format("structural similarity is taken of luminance; expected 1 channel, not {}",
                            imageLuminance.channels()));
  }
  const ComparablePair pair = comparable(imageLuminance, referenceLuminance);
  const ImageBuffer map = ssimMap(pair.image, pair.reference);
  double sum = 0.0;
  std::size_t count = 0;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width()) + static_cast<std::size_t>(x);
      if (pair.counts[pixel] == 0 || !ssimCounts(map, x, y)) continue;
      sum += double{map.values()[pixel]};
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

}  // namespace lumivox
