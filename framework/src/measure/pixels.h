// What the metrics of this part share: which pixels count, and pairs of pictures that differ in no other
// pixel.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "lumivox/base/picture.h"

namespace lumivox {

/// Rec. 709 luminance of linear R, G, B (ITU-R BT.709, item 3.2).
inline constexpr std::array<double, 3> kLuminanceWeights = {0.2126, 0.7152, 0.0722};

/// What cannot be told.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Whether all channels of a pixel that hold radiance are finite. A pixel of which one is not counts nowhere:
/// this is the one rule of every number that compares pictures.
bool finiteAt(const Picture& picture, std::size_t pixel, int radianceChannels);

/// A picture and its truth, made comparable: radiance channels only (1 or 3), and both equal where either is
/// NaN or infinite, so that such a pixel neither counts nor spreads into its neighbours through a filter.
struct ComparablePair {
  Picture picture, truth;
  std::vector<unsigned char> counts;  ///< for each pixel: 1 when it is finite in both
  std::uint64_t nonFinitePicture = 0, nonFiniteTruth = 0;
};

/// Error when the shapes differ or the channels are neither 1 nor 3 nor 4 (then the last is alpha and does
/// not count).
ComparablePair comparable(const Picture& picture, const Picture& truth);
/// The same of several pictures of one truth: a pixel that is not finite in one of them counts in none, so
/// that they are judged by the same pixels of the same truth.
std::vector<ComparablePair> comparable(std::span<const Picture> pictures, const Picture& truth);

/// How many channels of a picture hold radiance: 1, or 3 of 3 or 4. Error naming `what` otherwise.
int radianceChannels(const Picture& picture, std::string_view what);

/// Luminance of one pixel.
double luminanceAt(const Picture& picture, std::size_t pixel);

/// LDR-FLIP and HDR-FLIP of pairs without bad pixels; the exposures (in stops) of the latter are found from
/// the truth.
Picture flipLdrOf(const Picture& picture, const Picture& truth, double pixelsPerDegree);
Picture flipHdrOf(const Picture& picture, const Picture& truth, double pixelsPerDegree,
                  const std::vector<double>& stops);
/// The maps of several pictures of one truth, and of the first against another truth (null: none): what the
/// eye makes of each picture is found once for each exposure, which is where the time goes.
struct FlipMaps {
  std::vector<Picture> ofPictures;
  Picture againstOther;
};
FlipMaps flipLdrMaps(std::span<const Picture* const> pictures, const Picture& truth, const Picture* other,
                     double pixelsPerDegree);
FlipMaps flipHdrMaps(std::span<const Picture* const> pictures, const Picture& truth, const Picture* other,
                     double pixelsPerDegree, const std::vector<double>& stops);
std::vector<double> flipExposures(const Picture& truth);
/// NaN where a pixel does not count.
Picture withBadPixelsMarked(Picture map, const std::vector<unsigned char>& counts);

/// The structural similarity of each pixel's window; planes of luminance in [0,1].
Picture ssimMap(const Picture& pictureLuminance, const Picture& truthLuminance);
/// Whether ssim() counts the pixel: its window must lie within the picture, unless the picture is smaller
/// than a window.
bool ssimCounts(const Picture& picture, int x, int y);

inline constexpr double kDefaultPixelsPerDegree =
    67.0206;  // 3840 pixels on 0.7 m seen from 0.7 m: 3840 pi / 180

}  // namespace lumivox
