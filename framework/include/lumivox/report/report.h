// The main job: every pipeline at every point of its sweep, error and time apart, one page.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/base/file.h"
#include "lumivox/gpu/device.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/reference/path_tracer.h"

namespace lumivox {

/// The name under which a pipeline's whole picture (its composite, see compositePicture) is judged.
inline constexpr const char* kWholePicture = "whole_picture";

/// Error of one output against one truth layer.
struct ComponentError {
  std::string output;     ///< name in the pipeline text, or kWholePicture
  std::string component;  ///< name(Contributes)
  std::string truth;  ///< layer: one_bounce_diffuse (bias) or indirect_diffuse (what the viewer misses), ...
  bool bias = true;   ///< against the truth of the technique's own model; false: against the full truth
  /// Of every number the mean over the seeds that were run; the uncertainty is the truth's noise and the
  /// standard error over the seeds, added in quadrature.
  PictureError error;
  int seeds = 1;  ///< that were run
  /// False: from a results store of schema 3 or before, where every number but the RMSE is of the first seed.
  bool everyMetricPerSeed = true;
  bool deterministic = false;  ///< two seeds gave the same bits, so that there is no noise to average
  double noiseRmse = 0.0;      ///< RMS of the picture's own noise, from the differences between the seeds
  ErrorParts parts;            ///< mean square over seeds = bias² + noise² + the truth's noise²
  Measured flicker{std::numeric_limits<double>::quiet_NaN(),
                   0.0};        ///< over the pairs of frames that follow; NaN when none was measured
  PictureError errorOfNothing;  ///< of a black picture: what leaving the component out would cost

  /// Whether there are seeds enough to claim anything: kLeastRepeats of them, or no random numbers at all.
  bool enoughSeeds() const { return deterministic || seeds >= kLeastRepeats; }
  /// rmse / RMSE of nothing: below 1 the component is better than none.
  double ratioToNothing() const;
};

/// The least time that the work of a pass can take on one resource of the device (report/device.h).
struct WorkBound {
  std::string resource;  ///< "texture sampling"
  double ms = 0.0;
};

/// One sweep point: both error and time, in one record.
struct ReportPoint {
  std::string scene, pipeline, sweep;  ///< scene and pipeline as given files; sweep empty: the default point
  ParameterValues parameters;          ///< all parameters of the pipeline at this point
  TimingStatistics frameMs;            ///< every kept pass runs
  TimingStatistics nextFrameMs;        ///< 1/60 s later, only what changed runs
  std::map<std::string, TimingStatistics> passDeviceMs, passHostMs;
  std::map<std::string, std::uint64_t> passBytes;
  /// What each pass does, counted in a frame of its own.
  std::map<std::string, Work> passWork;
  /// What each pass takes at least: one bound per resource, the largest first. Empty without the ceilings of
  /// this device.
  std::map<std::string, std::vector<WorkBound>> passBounds;
  std::string whyNotCounted;           ///< empty when passWork is there
  std::vector<std::string> passOrder;  ///< as they ran
  double frameworkShare = 0.0;         ///< time between passes / frame
  std::uint64_t peakBytes = 0;
  std::vector<ComponentError> errors;
  std::vector<std::string> healthFindings;
  std::vector<std::string> notes;  ///< what passes measured about themselves; not kept in the results store
  std::string failure;  ///< why it has no numbers (it did not fit into memory, ...); empty when it has
  std::string command;  ///< that repeats it
};

/// What leaving out saves, measured: the pruned and the unpruned pipeline timed alternately in one run.
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
  bool samePicture = false;                          ///< bit for bit: the law of leaving out

  double savedShare() const;      ///< of the unpruned frame time, 0..1
  double savedShareNext() const;  ///< of that of a frame that follows another, with a moving camera
};

struct ReportOptions {
  std::vector<std::filesystem::path> scenes,
      pipelines;                      ///< no pipelines: every committed one that suits the scene
  std::vector<std::string> settings;  ///< "name=value"; pins that axis of a sweep
  std::filesystem::path output = "out/report/index.html";
  int truthSamples = 0;       ///< per pixel; 0: truthSamplesFor(width, height)
  int width = 0, height = 0;  ///< 0: the camera's, reduced to at most 160 on a software rasteriser
  std::string camera;
  double time = 0.0;       ///< s
  std::uint64_t seed = 1;  ///< the first one
  int subpixels = 16;      ///< pictures that are judged are means over this many positions in the pixel
  int repeats = 5, seeds = kLeastRepeats;
  /// Pairs of frames 1/24 s apart whose flicker is measured where the scene moves; 0: none.
  int flickerPairs = 4;
  bool openSweeps = true;                         ///< false: only the default point
  int voxelResolution = 0;                        ///< of a section on the committed voxelisers; 0: none
  std::filesystem::path store;                    ///< results store that the points are added to; empty: none
  std::vector<double> equalTimesMs, equalErrors;  ///< of the tables; empty: round numbers from the data
  std::string commandLine;                        ///< as typed, for the page
  std::vector<std::string>
      repeatArguments;  ///< further options that a repeating command needs, e.g. --device
};

struct ReportSummary {
  std::vector<ReportPoint> points;
  std::size_t takenUp = 0;  ///< of them, those that an interrupted run had measured already
  std::vector<PruningRecord> pruning;
  std::vector<std::string> unsuited;  ///< "scene, pipeline: why" for those left out by themselves
  std::filesystem::path page, csv, json;
};

/// Writes the page, and beside it the same stem with .csv and .json. Error (before any work) when it cannot
/// be written, when the packaged chart library is absent, or when a text is wrong. Points are kept beside the
/// page, in a file with the extension .unfinished.sqlite, as soon as they are measured: when the report is
/// interrupted, the next one takes them up, and removes the file when its page is written. A point that fails
/// is one that says why.
ReportSummary makeReport(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                         const std::function<Scene(const std::filesystem::path&)>& loadScene);

/// The truth layer that a component's bias is measured against, and the one for what the viewer misses.
/// Empty names: a component without a truth.
std::pair<std::string, std::string> truthLayers(Contributes component);

/// One layer of a truth and its variance. Where the truth has no layer "one_bounce", direct and both
/// one-bounce layers are added up; nullopt when it is not there.
struct TruthLayer {
  Picture mean, variance;
};
std::optional<TruthLayer> truthLayer(const LayeredPicture& truth, const std::string& name);

/// What an output adds to the whole picture: the output named "final" or contributing final if there is one,
/// else the sum of the radiance components (direct, indirect_diffuse, indirect_glossy, scattered). Empty when
/// there is none of them.
Picture compositePicture(const FrameResult& frame);

/// Renders pruned and unpruned alternately, `repeats` times each after one warm-up. With 0 only the warm-up
/// is rendered, for the pictures, the bytes and the variants; nothing is timed.
PruningRecord measurePruning(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                             const Pipeline& pipeline, RenderOptions options, double time, int repeats);

/// The folder with the committed scenes (its `pipelines` beside them): found upwards from `start`, from the
/// working directory and from the running program; nullopt when there is none.
std::optional<std::filesystem::path> committedScenes(const std::filesystem::path& start = {});
/// Sorted *.pipeline files of a folder.
std::vector<std::filesystem::path> pipelinesIn(const std::filesystem::path& folder);

/// Why a pipeline does not suit a scene, or empty: it suits unless all that it adds to direct light needs
/// something that the scene lacks.
std::string whyUnsuited(const Pipeline& pipeline, TechniqueSource& techniques, const SceneTraits& traits);

/// Size of the camera's picture reduced to fit within `limit` pixels on its longer side, at least 1, aspect
/// kept.
std::pair<int, int> reducedResolution(int width, int height, int limit);
/// Samples per pixel at which the truth's noise is well below the techniques' errors and a small picture
/// takes less than a minute or two.
int truthSamplesFor(int width, int height);

/// Three digits, whole from 100 on: "0.0123", "4.56", "1548".
std::string formatMilliseconds(double milliseconds);

/// Three digits and the thousands: "1.23 G", "45.6 k".
std::string formatThousands(double value);

/// A share as "12 %", never "-0 %".
std::string formatPercent(double share);

}  // namespace lumivox
