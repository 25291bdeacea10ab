// The report: every pipeline at every point of its sweep, errors and times measured separately, in one
// record.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/reference/path_tracer.h"
#include "lumivox/results/report_record.h"

namespace lumivox {

struct ReportOptions {
  std::vector<std::filesystem::path> scenes,
      pipelines;                      ///< no pipelines: every committed one that suits the scene
  std::vector<std::string> settings;  ///< "name=value"; pins that axis of a sweep
  std::filesystem::path output = "out/report/index.html";  ///< the page
  int referenceSamples = 0;   ///< per pixel; 0: referenceSamplesFor(width, height)
  int width = 0, height = 0;  ///< 0: the camera's, reduced to at most 128 on a software rasteriser
  std::string camera;
  double time = 0.0;               ///< s
  std::uint64_t seed = 1;          ///< the first one
  std::optional<double> exposure;  ///< EV; otherwise viewExposure()
  Tone tone = kShownTone;          ///< of images; measures know nothing of it
  int subpixels = 16;              ///< images that are judged are means over this many positions in the pixel
  int repeats = 5, seeds = kLeastRepeats;
  /// Pairs of frames 1/24 s apart whose flicker is measured where the scene moves; 0: none.
  int flickerPairs = 4;
  /// Pipelines that accumulate are measured after 1, 2, 4 ... and this many frames of the still scene too, at
  /// their default parameters.
  int frames = 1;
  /// s, for measuring after the references; 0: no limit. What would end later is not begun: first a point for
  /// each technique, by the pipeline of its name, then the other default points, the points of sweeps in
  /// turns, and how much time leaving out saves. What passes do is counted only without a limit.
  double budgetSeconds = 0.0;
  bool isLook = false;  ///< the page says that one frame, one seed and few positions decide nothing
  /// Called once every text and every file of a scene is read, before the first image is rendered.
  std::function<void()> allRead;
  /// Told after points were measured: how many of how many, and about how many seconds the rest will take;
  /// below 0: that is not known.
  std::function<void(std::size_t done, std::size_t total, double secondsLeft)> progress;
  bool openSweeps = true;                         ///< false: only the default point
  int voxelResolution = 0;                        ///< of a section on the committed voxelizers; 0: none
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
  std::vector<std::pair<std::string, Display>> displays;  ///< of the images of each scene
  std::vector<std::string> unsuited;  ///< "scene, pipeline: why" for those left out by themselves
  /// Left out by the budget: points; pipelines whose saving by leaving out was not timed.
  std::size_t leftOutPoints = 0, leftOutPrunings = 0;
  /// If this budget began no point: the smallest budget that begins one, s; otherwise 0.
  double neededSeconds = 0.0;
};

/// The results store in which the points of a report on this page are kept until it is written.
std::filesystem::path unfinishedStoreOf(const std::filesystem::path& page);

/// Measures, and gives the record to `write` whenever there is more in it; the last time it is complete.
/// Error (before any work) when a text is wrong. Points are kept in unfinishedStoreOf(options.output) as soon
/// as they are measured: when the report is interrupted, or there was no time for all of them, the next one
/// takes them up. A report that lacks none removes those that no other report on this page wants, and the
/// file when nothing is left in it. A point that fails is one that says why.
ReportSummary makeReport(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                         const std::function<Scene(const std::filesystem::path&)>& loadScene,
                         const std::function<void(const ReportRecord&)>& write);

/// The reference layer that a component's bias is measured against, that of so many indirect bounces as its
/// technique models (Pass::indirectBounces()), and the one for what the viewer misses. Empty names: a
/// component without a reference.
std::pair<std::string, std::string> referenceLayers(Contributes component, int bounces = 1);

/// One layer of a reference and its variance. Where the reference has no layer "one_bounce", direct and both
/// one-bounce layers are added up; nullopt when it is not there.
struct ReferenceLayer {
  ImageBuffer mean, variance;
};
std::optional<ReferenceLayer> referenceLayer(const LayeredImage& reference, const std::string& name);

/// The part of the whole image that an output adds: the output named "final" or contributing final if there
/// is one, else the sum of the radiance components (direct, indirect_diffuse, indirect_glossy, scattered).
/// Empty when there is none of them.
ImageBuffer compositeImage(const FrameResult& frame);

/// Adds an image of the scene to an exposure, without the pixels that emit (reference/emission.h). Of an
/// image of another size than the snapshot's camera every pixel counts; an empty one is passed over.
void meterImage(ExposureMeter& meter, const Scene& scene, const SceneSnapshot& snapshot,
                const ImageBuffer& image);

/// EV at which a scene is shown through a camera, whoever makes the image: metered on a small path-traced
/// view of its own, which is kept in the cache of references. Of `view` camera, time, size, threads and the
/// use of the cache count; `times`: all of them share one exposure, in place of the view's time, s.
double viewExposure(const Scene& scene, const ReferenceOptions& view, const std::vector<double>& times = {});

namespace experiment {

/// The image that a pipeline converges to under sub-pixel motion of the camera (temporal anti-aliasing):
/// the mean of the outputs over so many positions inside the pixel, the centre when there is one. The rest of
/// the result is the first frame's; health findings are those of the first frame that has some. At each
/// position the image is that of the last of `frames` frames, of which the first knows nothing from before.
/// `apart` becomes half the difference between the mean over the outer positions and that over the inner
/// ones: what the mean over all may still be wrong by.
FrameResult renderFiltered(PipelineExecutor& executor, const SceneSnapshot& centre, int positions,
                           int frameIndex = 0, int frames = 1, FrameResult* apart = nullptr);

}  // namespace experiment

/// Renders pruned and unpruned alternately, `repeats` times each after one warm-up. With 0 only the warm-up
/// is rendered, for the images, the bytes and the variants; nothing is timed.
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

/// Size of the camera's image reduced to fit within `limit` pixels on its longer side, at least 1, aspect
/// kept.
std::pair<int, int> reducedResolution(int width, int height, int limit);
/// Samples per pixel at which the reference's noise is well below the techniques' errors and a small image
/// takes less than a minute or two.
int referenceSamplesFor(int width, int height);

}  // namespace lumivox
