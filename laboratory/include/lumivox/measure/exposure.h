// The exposure that an image is displayed with: that which shows its log-average luminance as middle grey
// (Reinhard et al. 2002).
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "lumivox/base/image.h"

namespace lumivox {

/// What the log-average luminance becomes: the key of a scene that is neither dark nor light.
inline constexpr double kKey = 0.18;

/// One exposure for as many images as are shown together: the frames of a sequence, the panels of a sheet.
/// Lamps that are seen do not count, so that they may fill any part of an image; neither do pixels that are
/// black, NaN or infinite. What is no radiance does not count.
class ExposureMeter {
 public:
  /// `emitting`: for each pixel whether it shows something that shines by itself; empty: that is not known,
  /// and every pixel counts. Error when it has another size than the image.
  void add(const ImageBuffer& image, std::span<const unsigned char> emitting = {});
  /// EV, in steps of 0.01, so that the number that is told repeats the image. Where everything that is not
  /// black emits, that counts; 0 where everything is black.
  /// Lower where otherwise more than a few in a thousand of the pixels that count had a channel of more than
  /// `white` once exposed, so that a dark hall with a patch of sun keeps what is drawn in the sun.
  double exposure(double white = std::numeric_limits<double>::infinity()) const;

 private:
  /// Of pixels whose luminance is above 0.
  struct Pixels {
    std::vector<float> luminances, brightest;  ///< `brightest`: of the channels
  };
  Pixels lit_, shining_;
};

/// How an image is displayed where radiance is displayed by `ofRadiance`: what is no radiance as it is,
/// whatever stands beside it. Whoever shows images asks this.
Display displayOf(const ImageBuffer& image, const Display& ofRadiance);

/// That of one image.
double displayExposure(const ImageBuffer& image, std::span<const unsigned char> emitting = {});

}  // namespace lumivox
