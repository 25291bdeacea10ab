#include "lumivox/measure/exposure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "measure/pixels.h"
#include "measure/quantile.h"

namespace lumivox {

void ExposureMeter::add(const ImageBuffer& image, std::span<const unsigned char> emitting) {
  radianceChannels(image, "an image whose exposure is wanted");
  if (!emitting.empty() && emitting.size() != image.pixelCount())
    throw Error(fmt::format("it is known of {} pixels whether they emit; expected {}", emitting.size(),
                            image.pixelCount()));
  if (!image.isRadiance()) return;
  for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel) {
    const auto luminance = static_cast<float>(luminanceAt(image, pixel));
    if (!std::isfinite(luminance) || luminance <= 0.0f) continue;
    Pixels& pixels = !emitting.empty() && emitting[pixel] != 0 ? shining_ : lit_;
    pixels.luminances.push_back(luminance);
    const float* values = image.values().data() + pixel * static_cast<std::size_t>(image.channels());
    pixels.brightest.push_back(image.channels() < 3 ? values[0]
                                                    : std::max({values[0], values[1], values[2]}));
  }
}

double ExposureMeter::exposure(double white) const {
  const Pixels& pixels = lit_.luminances.empty() ? shining_ : lit_;
  std::vector<float> luminances = pixels.luminances;
  if (luminances.empty()) return 0.0;
  // Reinhard et al. add a small constant before the logarithm, so that black pixels do not dominate. Here
  // pixels darker than kBlack of the bright quantile do not count: radiance has no fixed scale, and the lit
  // places of an image decide its exposure. A quantile, because fireflies are unbounded.
  constexpr double kBright = 0.95, kBlack = 1e-3;
  const double black = kBlack * quantileOf(luminances, kBright);
  double sum = 0.0;
  std::size_t count = 0;
  for (const float luminance : luminances) {
    if (double{luminance} < black) continue;
    sum += std::log2(double{luminance});
    ++count;
  }
  constexpr double kSteps = 100.0;  // per EV
  double exposure = std::log2(kKey) - sum / static_cast<double>(count);
  // Half of the 1 % that may be white, as a reserve for pixels that the meter does not sample.
  constexpr double kNotWhite = 0.995;
  std::vector<float> brightest = pixels.brightest;
  exposure = std::min(exposure, std::log2(white / quantileOf(brightest, kNotWhite)));
  exposure = std::round(kSteps * exposure) / kSteps;
  return std::clamp(exposure, -kLargestExposure, kLargestExposure) + 0.0;  // maps -0 to 0
}

Display displayOf(const ImageBuffer& image, const Display& ofRadiance) {
  return image.isRadiance() ? ofRadiance : Display{};
}

double displayExposure(const ImageBuffer& image, std::span<const unsigned char> emitting) {
  ExposureMeter meter;
  meter.add(image, emitting);
  return meter.exposure();
}

}  // namespace lumivox
