// Common parts of the metrics: which pixels count, and pairs of images that are equal in all others.
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

/// Whether all radiance channels of a pixel are finite. Other pixels do not count in any metric.
bool finiteAt(const ImageBuffer& image, std::size_t pixel, int radianceChannels);

/// An image and its reference with radiance channels only (1 or 3). Where either is not finite, both are
/// equal, so that such a pixel neither counts nor spreads through filters.
struct ComparablePair {
  ImageBuffer image, reference;
  std::vector<unsigned char> counts;  ///< for each pixel: 1 when it is finite in both
  std::uint64_t nonFiniteImage = 0, nonFiniteReference = 0;
};

/// Error if the shapes differ or the number of channels is not 1, 3 or 4. The fourth is alpha and does not
/// count.
ComparablePair comparable(const ImageBuffer& image, const ImageBuffer& reference);
/// The same for several images of one reference. A pixel that is not finite in one of them counts in none, so
/// that all are compared by the same pixels.
std::vector<ComparablePair> comparable(std::span<const ImageBuffer> images, const ImageBuffer& reference);

/// The number of radiance channels of an image: 1, or 3 of 3 or 4. Error naming `what` otherwise.
int radianceChannels(const ImageBuffer& image, std::string_view what);

/// Luminance of one pixel.
double luminanceAt(const ImageBuffer& image, std::size_t pixel);

/// LDR-FLIP and HDR-FLIP of pairs without bad pixels. The exposures (in stops) of HDR-FLIP come from the
/// reference.
ImageBuffer flipLdrOf(const ImageBuffer& image, const ImageBuffer& reference, double pixelsPerDegree);
ImageBuffer flipHdrOf(const ImageBuffer& image, const ImageBuffer& reference, double pixelsPerDegree,
                      const std::vector<double>& stops);
/// FLIP maps of several images of one reference, and of the first against another reference (null: none). The
/// percept of each image, which takes most of the time, is computed once for each exposure.
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
