#include "experiment/claimed_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "lumivox/measure/metrics.h"

namespace lumivox::experiment {
namespace {

/// Differences from the pixel's right and upper neighbours, where these exist.
double detailAt(const ImageBuffer& bright, std::size_t pixel) {
  const auto width = static_cast<std::size_t>(bright.width());
  const std::vector<float>& values = bright.values();
  double sum = 0.0;
  if (pixel % width + 1 < width) sum += std::abs(values[pixel + 1] - values[pixel]);
  if (pixel + width < values.size()) sum += std::abs(values[pixel + width] - values[pixel]);
  return 0.5 * sum;
}

double colourAt(const ImageBuffer& image, std::size_t pixel) {
  const auto channels = static_cast<std::size_t>(image.channels());
  const auto first = image.values().begin() + static_cast<std::ptrdiff_t>(pixel * channels);
  const auto [least, most] =
      std::minmax_element(first, first + static_cast<std::ptrdiff_t>(std::min<std::size_t>(channels, 3)));
  return static_cast<double>(*most) - static_cast<double>(*least);
}

}  // namespace

std::vector<std::size_t> comparedPixels(const ImageBuffer& image, bool darkest) {
  constexpr std::size_t kPart = 4;
  std::vector<std::size_t> pixels(image.pixelCount());
  std::iota(pixels.begin(), pixels.end(), std::size_t{0});
  if (!darkest) return pixels;
  const ImageBuffer bright = luminance(image);
  // NaN sorts last and equal values keep their order, so that every machine chooses the same pixels.
  const auto brightness = [&](std::size_t pixel) {
    const float value = bright.values()[pixel];
    return std::isfinite(value) ? value : std::numeric_limits<float>::infinity();
  };
  std::stable_sort(pixels.begin(), pixels.end(),
                   [&](std::size_t a, std::size_t b) { return brightness(a) < brightness(b); });
  pixels.resize(std::max<std::size_t>(pixels.size() / kPart, 1));
  return pixels;
}

double claimedValue(const ImageBuffer& image, const std::vector<std::size_t>& pixels,
                    ClaimedQuantity quantity) {
  const ImageBuffer bright = luminance(image);
  double luminances = 0.0, differences = 0.0;
  for (const std::size_t pixel : pixels) {
    luminances += static_cast<double>(bright.values()[pixel]);
    differences += quantity == ClaimedQuantity::colour ? colourAt(image, pixel) : detailAt(bright, pixel);
  }
  return quantity == ClaimedQuantity::luminance ? luminances / static_cast<double>(pixels.size())
                                                : differences / luminances;
}

}  // namespace lumivox::experiment
