// From linear radiance to the bytes that a window shows: exposure and curve, false colour, errors, and what
// is no number.
#pragma once

#include <string>
#include <vector>

#include "lumivox/base/display.h"
#include "lumivox/base/image.h"

namespace lumivox::viewer {

/// As Tone, and false colour: a ramp over the range of the image's luminance, with a legend in its units.
enum class Curve { srgb, linear, filmic, falseColour };
/// What is compared, pixel by pixel: (image - reference) / reference, blue below and red above; HDR-FLIP; the
/// square of the difference.
enum class ErrorMap { relative, flip, squared };

struct PictureLook {
  double exposure = 0.0;  ///< EV
  Curve curve = Curve::filmic;
  /// Pixels that are NaN or infinite: magenta, or what is beneath; both in turn flash.
  bool marksBadPixels = true;
  std::string unit{};  ///< of the values, for the legend
};

/// What colours stand for.
struct Legend {
  std::string text;                 ///< "luminance 0 to 12.5 W/(sr m^2)"
  std::vector<unsigned char> ramp;  ///< the colours from low to high: red, green and blue each; may be empty
};

/// Red, green and blue, row by row from the top, as a screen takes them.
struct Picture {
  int width = 0, height = 0;
  std::vector<unsigned char> bytes;
  std::vector<Legend> legends;
  std::size_t badPixels = 0;
  bool empty() const { return bytes.empty(); }
};

Picture pictureOf(const ImageBuffer& image, const PictureLook& look);
/// Images of the same shape; other shapes give an empty picture.
Picture errorPicture(const ImageBuffer& image, const ImageBuffer& reference, ErrorMap map);
/// The first picture to the left of `at` (0..1 of the width), the second to the right, a line between.
Picture splitPicture(const Picture& left, const Picture& right, double at);
/// Voxels over what is behind them: `brightness` of their surfaces, 0 where there are none; `seeThrough` is
/// the share of `behind`, black where there is none.
Picture overlaid(const Picture& voxels, const ImageBuffer& brightness, const Picture& behind,
                 double seeThrough);
/// Side by side, with a gap; a legend that both have is one.
Picture besides(const Picture& left, const Picture& right);

}  // namespace lumivox::viewer
