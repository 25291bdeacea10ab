// Measurements as plain values: errors, times, work, and what leaving out saved.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/measure/metrics.h"
#include "lumivox/measure/voxels.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/shader/work.h"

namespace lumivox {

/// The name under which a pipeline's whole image (its composite, see compositeImage) is judged.
inline constexpr const char* kWholeImage = "whole_image";

/// Error of one output against one reference layer.
struct ComponentError {
  std::string output;     ///< name in the pipeline text, or kWholeImage
  std::string component;  ///< name(Contributes)
  std::string
      reference;  ///< layer: one_bounce_diffuse (bias) or indirect_diffuse (what the viewer misses), ...
  bool bias =
      true;  ///< against the reference of the technique's own model; false: against the full reference
  /// Of every number the mean over the seeds that were run; the uncertainty is the reference's noise and the
  /// standard error over the seeds, added in quadrature.
  ImageError error;
  int seeds = 1;  ///< that were run
  /// False: from a results store of schema 3 or before, where every number but the RMSE is of the first seed.
  bool everyMetricPerSeed = true;
  bool deterministic = false;  ///< every seed gives the same bits, so that there is no noise to average
  double noiseRmse = 0.0;      ///< RMS of the image's own noise, from the differences between the seeds
  ErrorParts parts;            ///< mean square over seeds = bias² + noise² + the reference's noise²
  Measured flicker{std::numeric_limits<double>::quiet_NaN(),
                   0.0};      ///< over the pairs of frames that follow; NaN when none was measured
  ImageError errorOfNothing;  ///< of a black image: what leaving the component out would cost

  /// Whether there are seeds enough to claim anything: kLeastRepeats of them, or no random numbers at all.
  bool enoughSeeds() const { return deterministic || seeds >= kLeastRepeats; }
  /// rmse / RMSE of nothing: below 1 the component is better than none.
  double ratioToNothing() const;
};

/// The least time that the work of a pass can take on one resource of the device (roofline/peak_rates.h).
struct WorkBound {
  std::string resource;  ///< "texture sampling"
  double ms = 0.0;
};

/// The frames that a point accumulates (kAccumulatedFrames is among its parameters where these are more than
/// one); 1 without the axis.
int framesOf(const ParameterValues& parameters);

/// The voxels that the indirect light of a point is gathered from, against those that the scene's triangles
/// touch, of the first seed. Of lists of fragments the one nearest to the output; without a list the nearest
/// grid of bits or opacities.
struct GatheredVoxels {
  std::string output;        ///< "voxels.fragments"
  std::string kind;          ///< of the port
  std::string whyNot;        ///< why they were not judged; empty when they were
  glm::ivec3 resolution{0};  ///< of their grid
  std::uint64_t occupied = 0;
  std::uint64_t reference = 0;  ///< voxels that the exact test is certain of
  std::uint64_t undecided = 0;  ///< touched or missed by no more than kContactTolerance
  VoxelError error;
  RayHoles holes;
};

/// One sweep point: both error and time, in one record.
struct ReportPoint {
  std::string scene, pipeline, sweep;  ///< scene and pipeline as given files; sweep empty: the default point
  ParameterValues parameters;          ///< all parameters of the pipeline at this point
  TimingStatistics frameMs;            ///< every kept pass runs; of several frames all of them, from nothing
  TimingStatistics nextFrameMs;        ///< 1/60 s later, only what changed runs
  TimingStatistics stillFrameMs;       ///< of a frame that follows another while nothing moves
  TimingStatistics movedFrameMs;       ///< of one before which the camera and every light have moved
  std::map<std::string, TimingStatistics> passDeviceMs, passHostMs;
  std::map<std::string, std::uint64_t> passBytes;
  /// The work of each pass, counted in a frame of its own.
  std::map<std::string, Work> passWork;
  /// Lower bounds on the time of each pass: one per resource, the largest first. Empty without the peak rates
  /// of this device.
  std::map<std::string, std::vector<WorkBound>> passBounds;
  std::string whyNotCounted;           ///< empty when passWork is there
  std::vector<std::string> passOrder;  ///< as they ran
  double frameworkShare = 0.0;         ///< time between passes / frame
  std::uint64_t peakBytes = 0;
  std::vector<ComponentError> errors;
  std::optional<GatheredVoxels> voxels;  ///< none: its indirect light is gathered from no voxels
  std::vector<std::string> healthFindings;
  std::vector<std::string> notes;  ///< what passes measured about themselves; not kept in the results store
  std::string failure;  ///< why it has no numbers (it did not fit into memory, ...); empty when it has
  std::string command;  ///< that repeats it
  /// Positions in the pixel that its images are means over; not kept in the results store.
  int subpixels = 0;
  /// s that measuring it took in this process, by what for; not kept in the results store.
  std::map<std::string, double> measuringSeconds;
};

/// The cost of a frame in parts: once (preprocessing), when something moves, and every time. NaN where that
/// is not known: it was not measured, or the point is one of several frames.
struct CostParts {
  Measured onceMs, movingMs, everyFrameMs;
};
CostParts costParts(const ReportPoint& point);

/// The measured saving by leaving out: the pruned and the unpruned pipeline, timed alternately in one run.
struct PruningRecord {
  std::string scene, pipeline;
  Explanation explanation;                        ///< savedMs is filled in for passes
  TimingStatistics prunedMs, unprunedMs;          ///< frames in which nothing is known from before
  TimingStatistics nextPrunedMs, nextUnprunedMs;  ///< frames that follow 1/60 s after another
  std::map<std::string, TimingStatistics> prunedPassMs,
      unprunedPassMs;                  ///< device; a missing pass did not run
  std::vector<std::string> passOrder;  ///< of the unpruned pipeline
  std::map<std::string, std::uint64_t> prunedPassBytes, unprunedPassBytes;
  std::uint64_t prunedBytes = 0, unprunedBytes = 0;  ///< all resources of the passes
  bool sameImage = false;                            ///< bit for bit: the law of leaving out

  double savedShare() const;  ///< by leaving out: of the unpruned time of a first frame, 0..1
  /// By standing still: the share of a pruned first frame's time that a later frame under a moving camera
  /// saves.
  double standingShare() const;
};

/// A peak rate of one device, measured: `lumivox device`.
struct PeakRate {
  std::string name;       ///< "texture_sampling_rgba16f_3d"
  std::string unit;       ///< "samples/s", "writes/s", "operations/s", "bytes/s"
  TimingStatistics rate;  ///< in that unit
  std::string created, version, device, driver, shaderInput, host;
};

/// The metrics of one error by name, with the same of a black image: what the store's table `metrics`
/// holds. Names: rmse, relative_mse, mean_ratio, bias, percentile95, ssim, flip, flip_ldr,
/// rms_bias, rms_noise, flicker, exposure_ev (at which SSIM and LDR-FLIP were taken), noise_floor,
/// non_finite_image, non_finite_reference.
struct NamedMetric {
  std::string name;
  Measured measured;
  double ofNothing = 0.0;
};
std::vector<NamedMetric> metricsOf(const ComponentError& error);
/// The inverse: fills the error's numbers from one metric; false for a name that it does not know.
bool setMetric(ComponentError& error, const NamedMetric& metric);

}  // namespace lumivox
