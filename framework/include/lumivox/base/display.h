// From linear radiance to display values: exposure and tone curve, the same for every displayed image. EXR
// files and measures of radiance do not use it.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

namespace lumivox {

/// The tone curve of exposed radiance. `srgb` clips at 1 and encodes by the sRGB curve; `filmic` applies
/// FilmicCurve before that, which keeps bright light below 1; `linear` clips and stores the values unchanged.
enum class Tone { linear, srgb, filmic };
const char* name(Tone tone);              ///< "linear", "srgb", "filmic"
Tone toneNamed(const std::string& word);  ///< Error for any other word

/// The default for displayed images: sunlit floors and sheets keep their detail, which `srgb` clips to white.
inline constexpr Tone kShownTone = Tone::filmic;

/// The largest exposure, up or down, EV: no radiance in single precision needs more.
inline constexpr double kLargestExposure = 100.0;

struct Display {
  double exposure = 0.0;  ///< EV: radiance is multiplied by 2^exposure
  Tone tone = Tone::srgb;
  float factor() const { return static_cast<float>(std::exp2(exposure)); }
};

/// "+1.25 EV"
std::string exposureText(double exposure);

/// Narkowicz's fit of the ACES curve (Narkowicz 2016: 2.51, 0.03, 2.43, 0.59, 0.14) with the film exposure
/// 0.6 taken in, as a quotient (k0 x^2 + k1 x + k2) / (k3 x^2 + k4 x + k5). HDR-FLIP uses the same.
struct FilmicCurve {
  static constexpr double kFilm = 0.6;
  static constexpr double k0 = kFilm * kFilm * 2.51, k1 = kFilm * 0.03, k2 = 0.0;
  static constexpr double k3 = kFilm * kFilm * 2.43, k4 = kFilm * 0.59, k5 = 0.14;

  static double apply(double radiance) {
    if (radiance <= 0.0) return 0.0;
    // Divided by x^2, so that the brightest finite radiance does not overflow.
    const double inverse = 1.0 / radiance;
    const double value = (k0 + (k1 + k2 * inverse) * inverse) / (k3 + (k4 + k5 * inverse) * inverse);
    return std::isnan(value) ? 0.0 : std::clamp(value, 0.0, 1.0);
  }
  /// The radiance that the curve maps to `value`: the positive root of a quadratic.
  static double inverse(double value) {
    const double c0 = (k1 - k4 * value) / (k0 - k3 * value);
    const double c1 = (k2 - k5 * value) / (k0 - k3 * value);
    return -0.5 * c0 + std::sqrt(0.25 * c0 * c0 - c1);
  }
};

/// The linear value in [0,1] whose sRGB code the display is given for exposed radiance. NaN stays NaN.
float toneMapped(float exposed, Tone tone);

}  // namespace lumivox
