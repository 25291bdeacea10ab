// Differences between images, in linear radiance unless said otherwise; health and repeated timings.
// Definitions, reasons and how the reference's noise enters: docs/metrics.md. Everything here gives the same
// bits on any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "lumivox/base/image.h"

namespace lumivox {

/// Fewer repeats or seeds than this say too little about their own spread for any claim.
inline constexpr int kLeastRepeats = 3;

/// A number with its standard uncertainty (one sigma).
struct Measured {
  double value = 0.0;
  double uncertainty = 0.0;
  /// False: from fewer than kLeastRepeats repeats or seeds, so that `uncertainty` lacks what chance does;
  /// whether it differs from another is then undecided.
  bool enoughRepeats = true;
};

/// Every number compares an image with a reference; pixels that are NaN or infinite in either are left out
/// and counted. A number that does not exist (every pixel left out, a ratio to a black reference) is NaN.
/// Alpha, the fourth channel, does not count.
struct ImageError {
  Measured rmse;         ///< root mean square over pixels and channels
  Measured relativeMse;  ///< mean of (x - t)^2 / (t^2 + epsilon^2), epsilon = 1 % of the reference's mean
  Measured meanRatio;    ///< sum of image / sum of reference; NaN when the reference is black
  Measured bias;         ///< mean signed difference
  /// 95th percentile of the absolute difference of luminance.
  double percentile95 = 0.0;
  /// Mean structural similarity (Wang et al. 2004) of luminance as displayed at `exposure`.
  double ssim = 1.0;
  /// Mean HDR-FLIP (Andersson et al. 2021).
  double flip = 0.0;
  /// Mean LDR-FLIP (Andersson et al. 2020) of the images at `exposure`, clipped.
  double flipLdr = 0.0;
  /// EV at which SSIM and LDR-FLIP were taken, the only two that depend on one; NaN where nobody has kept it.
  double exposure = std::numeric_limits<double>::quiet_NaN();
  /// How far doubling the reference's noise moves these four; 0 when the noise is not known.
  double percentile95Uncertainty = 0.0, ssimUncertainty = 0.0, flipUncertainty = 0.0,
         flipLdrUncertainty = 0.0;
  /// The RMSE that the reference's own noise alone causes, sqrt(mean variance). It is a part of `rmse`.
  double noiseFloor = 0.0;
  std::uint64_t nonFiniteImage = 0, nonFiniteReference = 0;  ///< pixels
};

/// `referenceVariance` (variance of each reference value, as of its mean) may be empty: then all
/// uncertainties are 0. Those of the first four numbers are propagated from it to first order. `exposure`,
/// EV: that of display (measure/exposure.h); otherwise the one of the reference's own pixels. Error when the
/// shapes differ, the channels are not 1, 3 or 4, or a variance is negative or not finite.
ImageError compare(const ImageBuffer& image, const ImageBuffer& reference,
                   const ImageBuffer& referenceVariance = {}, std::optional<double> exposure = std::nullopt);

/// The same image made with different random numbers, against one reference. A pixel that is not finite in
/// one of them counts in none.
struct SeedsError {
  /// Of every number the mean over the images; its uncertainty is the reference's noise and the standard
  /// error over the images, added in quadrature. nonFiniteImage: of the worst image.
  ImageError mean;
  ImageBuffer flipMap;  ///< flipHdr() of the first image
};
/// Errors as compare(), and for no image at all.
SeedsError compareSeeds(std::span<const ImageBuffer> seeds, const ImageBuffer& reference,
                        const ImageBuffer& referenceVariance = {},
                        std::optional<double> exposure = std::nullopt);

/// FLIP maps, one channel in [0,1], NaN where a pixel is left out. Radiance below 0 counts as 0; flipLdr
/// clips at 1. 67 pixels per degree unless said otherwise (the papers' default viewing condition).
ImageBuffer flipLdr(const ImageBuffer& linearImage, const ImageBuffer& linearReference,
                    double pixelsPerDegree = 67.0206);
ImageBuffer flipHdr(const ImageBuffer& linearImage, const ImageBuffer& linearReference,
                    double pixelsPerDegree = 67.0206);

/// Terms of the mean square error of an image with random numbers: bias² + noise² + referenceNoise². The
/// squares are unbiased estimates; where chance makes one negative, its root is given as 0.
struct ErrorParts {
  Measured bias{std::numeric_limits<double>::quiet_NaN(),
                0.0};  ///< RMS of the error left when noise is averaged away; NaN: unknown
  Measured noise{std::numeric_limits<double>::quiet_NaN(),
                 0.0};          ///< RMS of the image's own noise; NaN for a single image
  double referenceNoise = 0.0;  ///< RMS of the reference's noise; 0 when it is not known
};
/// `seeds`: the same image made with different random numbers, or a single image `withoutNoise`, as two
/// that are the same are. From three images on the uncertainty is that of the jackknife over them, which
/// needs no independence of pixels; of two it is the bound for pixels that all err together. Definitions and
/// derivations: docs/metrics.md. Error as for compare().
ErrorParts errorParts(const std::vector<ImageBuffer>& seeds, const ImageBuffer& reference,
                      const ImageBuffer& referenceVariance = {}, bool withoutNoise = false);

/// Mean structural similarity of two one-channel images with values in [0,1], over the windows that lie
/// within the image.
double ssim(const ImageBuffer& imageLuminance, const ImageBuffer& referenceLuminance);

/// Changes between consecutive frames that the reference does not make: RMS over pixels of ((p1-p0) -
/// (t1-t0)).
double flicker(const ImageBuffer& frame0, const ImageBuffer& frame1, const ImageBuffer& reference0,
               const ImageBuffer& reference1);

/// The same over a sequence: RMS over consecutive pairs, from which the reference's noise is subtracted,
/// which must be independent from frame to frame. Where chance makes the square negative, 0. `variances` may
/// be empty. NaN for fewer than two frames; Error when there are not as many references as frames.
Measured flicker(const std::vector<ImageBuffer>& frames, const std::vector<ImageBuffer>& references,
                 const std::vector<ImageBuffer>& variances = {});

/// A one-channel map in [0,1] in the report's ramp, black over violet and orange to pale yellow, whose
/// lightness grows in proportion to the value; linear RGB for writePng. NaN stays NaN.
ImageBuffer falseColour(const ImageBuffer& map);

ImageBuffer luminance(const ImageBuffer& rgb);  ///< Rec. 709 weights; one channel is luminance already

// ---- health
struct Health {
  std::uint64_t nan = 0, infinite = 0, negative = 0;
  std::int64_t firstBad = -1;       ///< index of the first bad value
  double sum = 0.0, largest = 0.0;  ///< of the finite values
  bool good() const { return nan == 0 && infinite == 0 && negative == 0; }
};
/// `count` numbers, `components` to an element. -infinity counts as infinite, not as negative. Without
/// `alphaToo` every element's fourth number is passed over.
Health scanHealth(const float* values, std::size_t count, int components, bool alphaToo = true);

// ---- repeated timings
/// Quartiles are interpolated linearly between the sorted values. Without values all is 0.
struct TimingStatistics {
  double median = 0, lowerQuartile = 0, upperQuartile = 0, smallest = 0, largest = 0;
  int repeats = 0;
};
TimingStatistics statisticsOf(std::vector<double> values);
/// The median with its standard error, sqrt(pi/2) sigma / sqrt(n) for n normal values; sigma from the
/// quartiles, which are 1.349 sigma apart. Without kLeastRepeats it says so.
Measured medianOf(const TimingStatistics& statistics);

/// Mean and standard error of the mean over seeds. One seed has no spread to measure: its uncertainty is 0,
/// and whoever reports it says that there was one.
Measured meanOverSeeds(const std::vector<double>& values);

}  // namespace lumivox
