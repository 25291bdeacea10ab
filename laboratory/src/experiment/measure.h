// Measures the points of one scene: their errors against its reference and, apart from that, their times.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/experiment/report.h"
#include "lumivox/results/report_record.h"

namespace lumivox::experiment {

/// The reference of a scene. The layers that outputs are judged by are added up once.
class SceneReference {
 public:
  /// `given`: an exposure, EV, in place of the scene's own. The scene must outlive this.
  SceneReference(const Scene& scene, const ReferenceOptions& options,
                 std::optional<double> given = std::nullopt);
  const LayeredImage& layers() const { return layers_; }
  /// Makes the layers of so many bounces where they are missing. Pointers from layer() become invalid.
  void require(int bounces);
  /// Null where the reference has no such layer, and in a scene lit by captures none of which stands for a
  /// scene: the constructor warns that its truth is unknown.
  const ReferenceLayer* layer(const std::string& name);
  /// The reference `frame` frames of an animation later, for flicker. It has a quarter of the samples (at
  /// least 16 per pixel, if this one has as many), different ones in every frame, so that its noise is
  /// independent. Frame 0 is this one.
  SceneReference& later(int frame);
  /// The error of an empty image against this layer: black, or 1 for ambient occlusion.
  const ImageError& errorOfNothing(const std::string& name);
  /// EV at which the scene's images are shown and judged: viewExposure().
  double exposure();
  /// How images that are judged against this layer are shown: at that exposure, or, for occlusion, which is a
  /// fraction, as they are.
  Display display(const std::string& layer, Tone tone = Tone::srgb);
  double seconds() const { return seconds_; }

 private:
  const Scene* scene_;
  ReferenceOptions options_;
  std::optional<double> exposure_;  ///< set once it is known
  bool lacksTruth_ = false;
  std::map<int, std::unique_ptr<SceneReference>> later_;
  LayeredImage layers_;
  std::map<std::string, std::optional<ReferenceLayer>> cache_;
  std::map<std::string, ImageError> nothing_;
  double seconds_ = 0.0;
};

/// Marks a point as failed: clears its numbers and records the reason.
void fail(ReportPoint& point, const std::string& why);
/// Runs the work and returns what went wrong, or nothing. An error in a text is wrong at every point and is
/// thrown on.
std::string whyFailed(const std::function<void()>& work);

struct TimingContext {
  gpu::Device& device;
  TechniqueSource& techniques;
  const Scene& scene;
  const ReportOptions& options;
  int width, height;
  std::shared_ptr<TransientMemory> transientMemory = nullptr;  ///< RenderOptions::transientMemory
};
struct MeasureContext : TimingContext {
  SceneReference& reference;
};

/// Adds the duration of a scope, s, to a point under its purpose.
class Measuring {
 public:
  Measuring(ReportPoint& point, const char* what) : seconds_(point.measuringSeconds[what]) {}
  ~Measuring() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  Measuring(const Measuring&) = delete;
  Measuring& operator=(const Measuring&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Render options of the frames that measure a point.
RenderOptions renderOptionsOf(const TimingContext& context, const ReportPoint& point);

/// The number of indirect bounces that each output of a pipeline models, by name; kWholeImage has the most of
/// them.
std::map<std::string, int> bouncesOf(const PipelineExecutor& executor);
/// Whether some pass continues from earlier frames, so that images improve while nothing changes: one that
/// reads its own history, or has an input of the last frame bound.
bool isProgressive(const Pipeline& pipeline, TechniqueSource& techniques);

/// Fills the errors, images and health of a point from an executor of its own.
void measureErrors(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record);
/// Time between the frames whose flicker is measured, s.
inline constexpr double kFlickerStep = 1.0 / 24.0;
/// Whether to measure flicker: something moves in the meantime.
bool flickers(const Scene& scene, const ReportOptions& options);
/// Adds the flicker to a point's errors where the scene moves.
void measureFlicker(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record);
/// Outputs, as pass and port, that stay alive although no image needs them.
using KeptOutputs = std::vector<std::pair<std::string, std::string>>;
/// Fills the work of the passes, counted in a frame of its own.
void countWork(const TimingContext& context, const Pipeline& pipeline, ReportPoint& point,
               const KeptOutputs& kept = {});

/// One point that is timed frame by frame, so that several points can take turns and a drifting machine
/// biases none of them. It keeps no images.
class TimedPoint {
 public:
  /// Renders one frame to warm up: it links programs and fills the pool.
  TimedPoint(const TimingContext& context, const Pipeline& pipeline, ReportPoint& point,
             const KeptOutputs& kept = {});
  ~TimedPoint();
  TimedPoint(TimedPoint&&) noexcept;
  void timeFrame();  ///< runs every kept pass; a point of several frames renders all of them from nothing
  /// Whether the frames agree within the spread that is reported, so that further ones would add nothing.
  bool isSettled() const;
  void timeNextFrame();   ///< renders 1/60 s after the last one
  void timeStillFrame();  ///< renders at the time of the last one; nothing moves
  /// Moves the camera and every light first. The first call releases the resources of the other frames and
  /// warms up anew.
  void timeMovedFrame();
  void finish();  ///< fills the point's times; may be called again after further frames
  const PipelineExecutor& executor() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The reference layers in use, for the page.
std::vector<ReferenceRecord> referenceRecords(SceneReference& reference, const std::set<std::string>& used,
                                              Tone tone);

}  // namespace lumivox::experiment
