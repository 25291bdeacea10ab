// Times one point frame by frame.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiment/measure.h"

namespace lumivox::experiment {

struct TimedPoint::State {
  ReportPoint& point;
  gpu::Device& device;
  TechniqueSource& techniques;
  const Scene& scene;
  const Pipeline& pipeline;
  RenderOptions options;
  const KeptOutputs kept;
  const double time;  ///< s
  const int frames;   ///< that the point accumulates
  std::optional<PipelineExecutor> executor;
  bool moving = false;  ///< the executor is that of moved frames
  int index = 0;        ///< of the last frame rendered
  double now = 0.0;     ///< its time, s
  std::vector<double> frameMs, shares, nextMs, stillMs, movedMs;
  std::map<std::string, std::vector<double>> deviceMs, hostMs;

  State(const TimingContext& context, const Pipeline& pipelineToTime, ReportPoint& pointToTime,
        KeptOutputs keptOutputs)
      : point(pointToTime),
        device(context.device),
        techniques(context.techniques),
        scene(context.scene),
        pipeline(pipelineToTime),
        options(renderOptionsOf(context, pointToTime)),
        kept(std::move(keptOutputs)),
        time(context.options.time),
        frames(framesOf(pointToTime.parameters)),
        now(time) {}

  /// Makes a new executor and renders its first frame.
  FrameResult warmUp() {
    executor.reset();  // frees its memory first
    executor.emplace(device, techniques, scene, pipeline, options);
    for (const auto& [pass, port] : kept) executor->keepOutput(pass, port);
    return executor->render(time, 0, PipelineExecutor::Images::no);
  }

  /// Renders the point's frames from nothing; returns their total time, ms, and the first frame.
  std::pair<double, FrameResult> fromNothing(PipelineExecutor::Timing timing) {
    executor->invalidate();
    executor->emptyHistories();
    FrameResult first = executor->render(time, 0, PipelineExecutor::Images::no, timing);
    double sum = first.frameMs;
    for (index = 1; index < frames; ++index)
      sum += executor->render(time, index, PipelineExecutor::Images::no, timing).frameMs;
    index = frames - 1;
    now = time;
    return {sum, std::move(first)};
  }
};

TimedPoint::TimedPoint(const TimingContext& context, const Pipeline& pipeline, ReportPoint& point,
                       const KeptOutputs& kept)
    : state_(std::make_unique<State>(context, pipeline, point, kept)) {
  const FrameResult frame = [&] {
    const Measuring measuring(point, "warm-up");
    return state_->warmUp();
  }();
  point.peakBytes = frame.peakBytes;
  point.passOrder.clear();  // of an attempt that failed
  for (const PassRecord& pass : frame.passes) {
    point.passOrder.push_back(pass.name);
    point.passBytes[pass.name] = pass.bytes;
  }
}

const PipelineExecutor& TimedPoint::executor() const {
  return *state_->executor;
}

TimedPoint::~TimedPoint() = default;
TimedPoint::TimedPoint(TimedPoint&&) noexcept = default;

namespace {
constexpr double kNextFrame = 1.0 / 60.0;  // s
}

void TimedPoint::timeFrame() {
  State& s = *state_;
  const Measuring measuring(s.point, "frames");
  const auto [milliseconds, first] = s.fromNothing(PipelineExecutor::Timing::frame);
  s.frameMs.push_back(milliseconds);
  if (first.frameMs > 0.0) s.shares.push_back(first.betweenPassesMs / first.frameMs);
  for (const PassRecord& pass : first.passes) s.hostMs[pass.name].push_back(pass.hostMs);
  // Passes are timed in frames of their own, since their instruments cost time. A pass's share of a frame
  // varies less than the frame's time.
  if (s.frameMs.size() <= kLeastRepeats) s.fromNothing(PipelineExecutor::Timing::passes);
}

bool TimedPoint::isSettled() const {
  constexpr double kSpread = 0.03;  // of the median, between the quartiles
  const State& s = *state_;
  if (s.frameMs.size() < kLeastRepeats) return false;
  const TimingStatistics statistics = statisticsOf(s.frameMs);
  return statistics.upperQuartile - statistics.lowerQuartile <= kSpread * statistics.median;
}

void TimedPoint::timeNextFrame() {
  State& s = *state_;
  const Measuring measuring(s.point, "next frames");
  s.now += kNextFrame;
  s.nextMs.push_back(s.executor->render(s.now, ++s.index, PipelineExecutor::Images::no).frameMs);
}

void TimedPoint::timeStillFrame() {
  State& s = *state_;
  const Measuring measuring(s.point, "still frames");
  s.stillMs.push_back(s.executor->render(s.now, ++s.index, PipelineExecutor::Images::no).frameMs);
}

void TimedPoint::timeMovedFrame() {
  constexpr float kStride = 1e-3f;  // of the scene
  State& s = *state_;
  const Measuring measuring(s.point, "moved frames");
  if (!s.moving) {
    finish();  // reads the times that the executor still holds
    s.options.interactive = true;
    s.moving = true;
    s.warmUp();
    s.index = 0;
    s.now = s.time;
  }
  s.now += kNextFrame;
  ++s.index;
  SceneSnapshot moved = snapshotOf(s.scene, s.now, s.options.camera, s.options.width, s.options.height);
  const float diagonal = moved.bounds.empty ? 1.0f : glm::length(moved.bounds.high - moved.bounds.low);
  const glm::vec3 step = moved.camera.right * (static_cast<float>(s.index) * kStride * diagonal);
  moved.camera.eye += step;
  for (LightState& light : moved.lights) {
    light.position += step;
    light.direction =
        glm::normalize(light.direction + moved.camera.right * (static_cast<float>(s.index) * kStride));
  }
  s.movedMs.push_back(s.executor->render(moved, s.index, PipelineExecutor::Images::no).frameMs);
}

void TimedPoint::finish() {
  State& s = *state_;
  const std::vector<std::vector<PassRecord>> timed = s.executor->timedPasses();
  // A point of several frames has the sum of each pass over all of them.
  for (std::size_t first = 0; first + static_cast<std::size_t>(s.frames) <= timed.size();
       first += static_cast<std::size_t>(s.frames)) {
    std::map<std::string, double> sums;
    for (std::size_t frame = first; frame < first + static_cast<std::size_t>(s.frames); ++frame)
      for (const PassRecord& pass : timed[frame]) sums[pass.name] += pass.deviceMs;
    for (const auto& [name, ms] : sums) s.deviceMs[name].push_back(ms);
  }
  s.point.frameMs = statisticsOf(s.frameMs);
  s.point.nextFrameMs = statisticsOf(s.nextMs);
  s.point.stillFrameMs = statisticsOf(s.stillMs);
  s.point.movedFrameMs = statisticsOf(s.movedMs);
  s.point.frameworkShare = s.shares.empty() ? 0.0 : statisticsOf(s.shares).median;
  for (const auto& [name, values] : s.deviceMs) s.point.passDeviceMs[name] = statisticsOf(values);
  for (const auto& [name, values] : s.hostMs) s.point.passHostMs[name] = statisticsOf(values);
}

}  // namespace lumivox::experiment
