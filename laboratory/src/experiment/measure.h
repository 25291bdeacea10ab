// One scene's share of a report: the reference, and every point measured for error and, apart from that, for
// time.
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

/// The reference of a scene with the layers that outputs are judged by, added up once.
class SceneReference {
 public:
  /// `given`: an exposure in place of its own, EV. The scene must outlive it.
  SceneReference(const Scene& scene, const ReferenceOptions& options,
                 std::optional<double> given = std::nullopt);
  const LayeredImage& layers() const { return layers_; }
  /// Sees to it that the layers of so many bounces are there; what layer() gave before is no more valid.
  void require(int bounces);
  /// Null when the reference has no such layer.
  const ReferenceLayer* layer(const std::string& name);
  /// The reference `frame` frames of an animation later, for flicker: with a quarter of the samples, which
  /// are others in every frame, so that its noise is independent. Frame 0 is this one.
  SceneReference& later(int frame);
  /// The error of an image of nothing against it: black, or 1 for ambient occlusion.
  const ImageError& errorOfNothing(const std::string& name);
  /// EV at which the images of the scene are shown and judged: viewExposure().
  double exposure();
  /// How images that are judged against this layer are shown: at that exposure, but for occlusion, a
  /// fraction, which is shown as it is.
  Display display(const std::string& layer, Tone tone = Tone::srgb);
  double seconds() const { return seconds_; }

 private:
  const Scene* scene_;
  ReferenceOptions options_;
  std::optional<double> exposure_;  ///< once it is known
  std::map<int, std::unique_ptr<SceneReference>> later_;
  LayeredImage layers_;
  std::map<std::string, std::optional<ReferenceLayer>> cache_;
  std::map<std::string, ImageError> nothing_;
  double seconds_ = 0.0;
};

/// Empties a point of its numbers, which are none, and says why.
void fail(ReportPoint& point, const std::string& why);
/// Does it, and says what went wrong; empty: nothing. A wrong text is wrong at every point and goes on up.
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

/// Adds to a point what a scope takes, s, by what it is for.
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

/// The options of frames that measure a point.
RenderOptions renderOptionsOf(const TimingContext& context, const ReportPoint& point);

/// How many indirect bounces each output of a pipeline models, by its name; kWholeImage: the most of them.
std::map<std::string, int> bouncesOf(const PipelineExecutor& executor);
/// Whether a pass goes on from what earlier frames left, so that the pipeline's images improve while
/// nothing changes.
bool isProgressive(const Pipeline& pipeline, TechniqueSource& techniques);

/// Fills the errors, images and health of a point, with an executor of its own.
void measureErrors(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record);
/// Time between the frames whose flicker is measured, s.
inline constexpr double kFlickerStep = 1.0 / 24.0;
/// Whether flicker is to be measured: something moves meanwhile.
bool flickers(const Scene& scene, const ReportOptions& options);
/// Fills the flicker of the errors that are there already, where the scene moves.
void measureFlicker(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record);
/// Outputs, pass and port, that stay alive although no image needs them.
using KeptOutputs = std::vector<std::pair<std::string, std::string>>;
/// Fills what the passes do, counted in a frame of its own.
void countWork(const TimingContext& context, const Pipeline& pipeline, ReportPoint& point,
               const KeptOutputs& kept = {});

/// One point that is timed frame by frame, so that the frames of several points can take turns: a machine
/// that drifts then biases none of them. No images are taken.
class TimedPoint {
 public:
  /// Renders one frame as warm-up: programs are linked, the pool is filled.
  TimedPoint(const TimingContext& context, const Pipeline& pipeline, ReportPoint& point,
             const KeptOutputs& kept = {});
  ~TimedPoint();
  TimedPoint(TimedPoint&&) noexcept;
  void timeFrame();  ///< every kept pass runs; of a point of several frames all of them, from nothing
  /// Its frames took the same time, as nearly as is told: further ones would say the same.
  bool isSettled() const;
  void timeNextFrame();   ///< 1/60 s after the last one
  void timeStillFrame();  ///< at the same time as the last one, nothing moves
  /// The camera and every light have moved since the last one. The first call gives the resources of the
  /// other frames back and warms up anew.
  void timeMovedFrame();
  void finish();  ///< fills the point's times; again after further frames
  const PipelineExecutor& executor() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The reference layers that were used, for the page.
std::vector<ReferenceRecord> referenceRecords(SceneReference& reference, const std::set<std::string>& used,
                                              Tone tone);

}  // namespace lumivox::experiment
