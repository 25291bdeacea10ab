// Common parts of the metrics: which pixels count, and pairs of images that differ in no other pixel.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "lumivox/base/image.h"

namespace lumivox {

/// Rec. 709 luminance of linear R, G, B (ITU-R BT.709, item 3.2).
inline constexpr std::array<double, 3> kLuminanceWeights = {0.2126, 0.7152, 0.0722};

/// An unknown value.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Whether all channels of a pixel that hold radiance are finite. A pixel of which one is not counts nowhere:
/// this is the one rule of every number that compares images.
bool finiteAt(const ImageBuffer& image, std::size_t pixel, int radianceChannels);

/// An image and its reference, made comparable: radiance channels only (1 or 3), and both equal where either
/// is NaN or infinite, so that such a pixel neither counts nor spreads into its neighbours through a filter.
struct ComparablePair {
  ImageBuffer image, reference;
  std::vector<unsigned char> counts;  ///< for each pixel: 1 when it is finite in both
  std::uint64_t nonFiniteImage = 0, nonFiniteReference = 0;
};

/// Error when the shapes differ or the channels are neither 1 nor 3 nor 4 (then the last is alpha and does
/// not count).
ComparablePair comparable(const ImageBuffer& image, const ImageBuffer& reference);
/// The same of several images of one reference: a pixel that is not finite in one of them counts in none, so
/// that they are judged by the same pixels of the same reference.
std::vector<ComparablePair> comparable(std::span<const ImageBuffer> images, const ImageBuffer& reference);

/// How many channels of an image hold radiance: 1, or 3 of 3 or 4. Error naming `what` otherwise.
int radianceChannels(const ImageBuffer& image, std::string_view what);

/// Luminance of one pixel.
double luminanceAt(const ImageBuffer& image, std::size_t pixel);

/// LDR-FLIP and HDR-FLIP of pairs without bad pixels; the exposures (in stops) of the latter are found from
/// the reference.
ImageBuffer flipLdrOf(const ImageBuffer& image, const ImageBuffer& reference, double pixelsPerDegree);
ImageBuffer flipHdrOf(const ImageBuffer& image, const ImageBuffer& reference, double pixelsPerDegree,
                      const std::vector<double>& stops);
/// The maps of several images of one reference, and of the first against another reference (null: none): what
/// the eye makes of each image is found once for each exposure, which is where the time goes.
struct FlipMaps {
  std::vector<ImageBuffer> ofImages;
  ImageBuffer againstOther;
};
FlipMaps flipLdrMaps(std::span<const ImageBuffer* const> images, const ImageBuffer& reference,
                     const ImageBuffer* other, double pixelsPerDegree);
FlipMaps flipHdrMaps(std::span<const ImageBuffer* const> images, const ImageBuffer& reference,
                     const ImageBuffer* other, double pixelsPerDegree, const std::vector<double>& stops);
std::vector<double> flipExposures(const ImageBuffer& reference);
/// NaN where a pixel does not count.
ImageBuffer withBadPixelsMarked(ImageBuffer map, const std::vector<unsigned char>& counts);

/// The structural similarity of each pixel's window; planes of luminance in [0,1].
ImageBuffer ssimMap(const ImageBuffer& imageLuminance, const ImageBuffer& referenceLuminance);
/// Whether ssim() counts the pixel: its window must lie within the image, unless the image is smaller
/// than a window.
bool ssimCounts(const ImageBuffer& image, int x, int y);

inline constexpr double kDefaultPixelsPerDegree =
    67.0206;  // 3840 pixels on 0.7 m seen from 0.7 m: 3840 pi / 180

}  // namespace lumivox
