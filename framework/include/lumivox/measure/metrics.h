// Differences between pictures, in linear radiance unless said otherwise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lumivox/base/picture.h"

namespace lumivox {

/// A number with its standard uncertainty (one sigma).
struct Measured {
  double value = 0.0;
  double uncertainty = 0.0;
};

/// Every number compares a picture with a truth; pixels that are NaN or infinite in either are left out and counted.
struct PictureError {
  Measured rmse;                ///< root mean square over pixels and channels
  Measured relativeMse;         ///< mean of (x - t)^2 / (t^2 + epsilon^2), epsilon = 1 % of the truth's mean
  Measured meanRatio;           ///< sum of picture / sum of truth; NaN when the truth is black
  Measured bias;                ///< mean signed difference
  double percentile95 = 0.0;    ///< of the absolute difference of luminance
  double ssim = 1.0;            ///< mean structural similarity of luminance, tone-mapped to [0,1] by the truth's exposure (Wang et al. 2004)
  double flip = 0.0;            ///< mean HDR-FLIP (Andersson et al. 2021)
  double flipLdr = 0.0;         ///< mean LDR-FLIP (Andersson et al. 2020) of the exposed, clipped pictures
  double noiseFloor = 0.0;      ///< RMSE that the truth's own noise alone causes: sqrt(mean variance)
  std::uint64_t nonFinitePicture = 0, nonFiniteTruth = 0;
};

/// `truthVariance` (variance of each truth value) may be empty. The uncertainty of each number is propagated from it to first order.
/// Error when the shapes differ.
PictureError compare(const Picture& picture, const Picture& truth, const Picture& truthVariance = {});

/// FLIP maps, one channel in [0,1]. 67 pixels per degree unless said otherwise (the papers' default viewing condition).
Picture flipLdr(const Picture& linearPicture, const Picture& linearTruth, double pixelsPerDegree = 67.0206);
Picture flipHdr(const Picture& linearPicture, const Picture& linearTruth, double pixelsPerDegree = 67.0206);

double ssim(const Picture& pictureLuminance, const Picture& truthLuminance);

/// Changes between consecutive frames that the truth does not make: RMS over pixels of ((p1-p0) - (t1-t0)).
double flicker(const Picture& frame0, const Picture& frame1, const Picture& truth0, const Picture& truth1);

/// The exposure at which the truth's 99th percentile of luminance becomes 0.8: used for display and LDR metrics; 1 for a black picture.
float displayExposure(const Picture& truth);

/// A one-channel map in [0,1] in the magma-like ramp of the report, as linear RGB for writePng.
Picture falseColour(const Picture& map);

Picture luminance(const Picture& rgb);  ///< Rec. 709 weights

// ---- voxels
struct VoxelError { std::uint64_t truePositive = 0, falsePositive = 0, falseNegative = 0; double precision() const; double recall() const; };
VoxelError compareVoxels(const std::vector<bool>& occupied, const std::vector<bool>& truth);

// ---- health
struct Health {
  std::uint64_t nan = 0, infinite = 0, negative = 0;
  std::int64_t firstBad = -1;   ///< index of the first bad value
  double sum = 0.0, largest = 0.0;
  bool good() const { return nan == 0 && infinite == 0 && negative == 0; }
};
Health scanHealth(const float* values, std::size_t count, int components, bool alphaToo = true);

// ---- repeated timings
struct TimingStatistics { double median = 0, lowerQuartile = 0, upperQuartile = 0, smallest = 0, largest = 0; int repeats = 0; };
TimingStatistics statisticsOf(std::vector<double> values);

/// Mean and standard error over seeds.
Measured meanOverSeeds(const std::vector<double>& values);

}  // namespace lumivox
