// Error maps as images. Equal steps of the value are equal steps of lightness, so that the ramp reads
// correctly.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"
#include "measure/pixels.h"

namespace lumivox {
namespace {

using Rgb = std::array<double, 3>;

double luminanceOf(const Rgb& rgb) {
  return kLuminanceWeights[0] * rgb[0] + kLuminanceWeights[1] * rgb[1] + kLuminanceWeights[2] * rgb[2];
}

/// The hue runs from violet through magenta and orange to pale yellow: linear R, G, B up to a factor.
Rgb hueAt(double value) {
  struct Stop {
    double value;
    Rgb hue;
  };
  static constexpr std::array<Stop, 6> kStops = {{{0.0, {0.16, 0.06, 0.60}},
                                                  {0.2, {0.30, 0.04, 0.55}},
                                                  {0.4, {0.62, 0.05, 0.40}},
                                                  {0.6, {1.00, 0.17, 0.16}},
                                                  {0.8, {1.00, 0.53, 0.13}},
                                                  {1.0, {1.00, 1.00, 0.62}}}};
  std::size_t i = 0;
  while (i + 2 < kStops.size() && value > kStops[i + 1].value) ++i;
  const double fraction = (value - kStops[i].value) / (kStops[i + 1].value - kStops[i].value);
  Rgb hue{};
  for (std::size_t c = 0; c < 3; ++c)
    hue[c] = kStops[i].hue[c] + fraction * (kStops[i + 1].hue[c] - kStops[i].hue[c]);
  return hue;
}

/// Each colour gets the luminance whose CIE lightness L* is proportional to the value.
Rgb rampAt(double value) {
  constexpr double kLightest = 97.0;  // L* of the ramp's end, slightly darker than white paper
  const double lightness = kLightest * value;
  // CIE 15: the inverse of L* = 116 Y^(1/3) - 16 above 8, of L* = 903.3 Y below.
  const double luminance =
      lightness > 8.0 ? std::pow((lightness + 16.0) / 116.0, 3.0) : lightness * 27.0 / 24389.0;
  Rgb colour = hueAt(value);
  const double factor = luminance / luminanceOf(colour);
  for (double& channel : colour) channel *= factor;
  // If a channel exceeds the display's range, the colour is mixed with grey of the same luminance.
  const double largest = *std::max_element(colour.begin(), colour.end());
  const double mix = largest > 1.0 ? (1.0 - luminance) / (largest - luminance) : 1.0;
  for (double& channel : colour) channel = luminance + mix * (channel - luminance);
  return colour;
}

}  // namespace

ImageBuffer falseColour(const ImageBuffer& map) {
  if (map.channels() != 1) {
    throw Error(fmt::format("a map with {} channels cannot be coloured; expected 1", map.channels()));
  }
  ImageBuffer result(map.width(), map.height(), 3);
  for (std::size_t pixel = 0; pixel < map.pixelCount(); ++pixel) {
    const float value = map.values()[pixel];
    const Rgb colour =
        std::isnan(value) ? Rgb{value, value, value} : rampAt(std::clamp(double{value}, 0.0, 1.0));
    for (std::size_t c = 0; c < 3; ++c) result.values()[pixel * 3 + c] = static_cast<float>(colour[c]);
  }
  return result;
}

}  // namespace lumivox
