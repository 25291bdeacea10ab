// Converts linear radiance to the bytes that a window shows: exposure and curve, false colour, error maps,
// and marks on pixels that are not finite.
#pragma once

#include <string>
#include <vector>

#include "lumivox/base/display.h"
#include "lumivox/base/image.h"

namespace lumivox::viewer {

/// The curves of Tone, and false colour: a ramp over the range of the image's luminance, with a legend in its
/// unit.
enum class Curve { srgb, linear, filmic, falseColour };
/// The error of each pixel. relative: (image - reference) / reference, blue below 0 and red above. flip:
/// HDR-FLIP. squared: the square of the difference.
enum class ErrorMap { relative, flip, squared };

struct PictureLook {
  double exposure = 0.0;  ///< EV
  Curve curve = Curve::filmic;
  /// Whether NaN and infinite pixels are magenta, else black. The session alternates it, so that they flash.
  bool marksBadPixels = true;
  std::string unit{};  ///< of the values, for the legend
};

/// The meaning of the colours.
struct Legend {
  std::string text;                 ///< "luminance 0 to 12.5 W/(sr m^2)"
  std::vector<unsigned char> ramp;  ///< colours from low to high as red, green and blue; may be empty
};

/// Red, green and blue bytes, row by row from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<unsigned char> bytes;
  std::vector<Legend> legends;
  std::size_t badPixels = 0;
  bool empty() const { return bytes.empty(); }
};

Picture pictureOf(const ImageBuffer& image, const PictureLook& look);
/// The error map of two images of the same shape; empty if the shapes differ.
Picture errorPicture(const ImageBuffer& image, const ImageBuffer& reference, ErrorMap map);
/// One picture to the left of `at` (0..1 of the width) and the other to the right, with a line between.
Picture splitPicture(const Picture& left, const Picture& right, double at);
/// Voxels over the picture behind them. `brightness`: of the voxels' surfaces, 0 where there is none.
/// `seeThrough`: the share of `behind`, which may be empty and then counts as black.
Picture overlaid(const Picture& voxels, const ImageBuffer& brightness, const Picture& behind,
                 double seeThrough);
/// Both pictures side by side with a gap; a legend that both have appears once.
Picture besides(const Picture& left, const Picture& right);

}  // namespace lumivox::viewer
