#include "report/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/base/low_discrepancy.h"
#include "lumivox/report/device.h"
#include "pipeline/changes.h"

namespace lumivox {

Measured ComponentError::rmse() const {
  return {rmseOverSeeds.value, std::hypot(error.rmse.uncertainty, rmseOverSeeds.uncertainty)};
}

double ComponentError::ratioToNothing() const {
  return errorOfNothing.rmse.value > 0.0 ? rmseOverSeeds.value / errorOfNothing.rmse.value
                                         : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace lumivox

namespace lumivox::report {
namespace {

/// The pictures of every output that has a truth, and the whole picture; per seed.
struct Judged {
  std::string output;
  Contributes component;
  std::vector<Picture> seeds;
};

RenderOptions renderOptions(const TimingContext& context, const ReportPoint& point) {
  RenderOptions options;
  options.parameters = point.parameters;
  options.seed = context.options.seed;
  options.camera = context.options.camera;
  options.width = context.width;
  options.height = context.height;
  return options;
}

void collect(std::vector<Judged>& judged, const std::string& output, Contributes component, Picture picture) {
  if (picture.empty() || truthLayers(component).first.empty()) return;
  const auto found =
      std::find_if(judged.begin(), judged.end(), [&](const Judged& one) { return one.output == output; });
  if (found == judged.end())
    judged.push_back({output, component, {std::move(picture)}});
  else
    found->seeds.push_back(std::move(picture));
}

void collectOutputs(std::vector<Judged>& judged, const PipelineExecutor& executor, FrameResult frame) {
  Picture whole = compositePicture(frame);
  for (const std::string& output : executor.outputNames()) {
    const auto picture = frame.outputs.find(output);
    const auto component = frame.components.find(output);
    // An output that is the whole picture already is judged as that, once.
    if (picture != frame.outputs.end() && component != frame.components.end() &&
        component->second != Contributes::final)
      collect(judged, output, component->second, std::move(picture->second));
  }
  collect(judged, kWholePicture, Contributes::final, std::move(whole));
}

/// RMSE over the values that are finite in both, as `compare` counts them.
double rmseOf(const Picture& picture, const Picture& truth) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < picture.values().size(); ++i) {
    const double difference = static_cast<double>(picture.values()[i]) - truth.values()[i];
    if (!std::isfinite(difference)) continue;
    sum += difference * difference;
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
}

/// Root of the mean unbiased variance of a value over the seeds: the picture's own noise.
double noiseOver(const std::vector<Picture>& seeds) {
  if (seeds.size() < 2) return 0.0;
  double sum = 0.0;
  std::size_t values = 0;
  for (std::size_t i = 0; i < seeds.front().values().size(); ++i) {
    double mean = 0.0, squares = 0.0;
    for (const Picture& seed : seeds) mean += seed.values()[i];
    mean /= static_cast<double>(seeds.size());
    for (const Picture& seed : seeds) squares += (seed.values()[i] - mean) * (seed.values()[i] - mean);
    if (!std::isfinite(squares)) continue;
    sum += squares / static_cast<double>(seeds.size() - 1);
    ++values;
  }
  return values == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(values));
}

bool sameValues(const Picture& a, const Picture& b) {
  return a.sameShape(b) &&
         std::equal(a.values().begin(), a.values().end(), b.values().begin(),
                    [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

ComponentError errorAgainst(const Judged& judged, Truth& truth, const std::string& layer, bool bias) {
  const TruthLayer& reference = *truth.layer(layer);
  ComponentError record;
  record.output = judged.output;
  record.component = name(judged.component);
  record.truth = layer;
  record.bias = bias;
  record.error = compare(judged.seeds.front(), reference.mean, reference.variance);
  record.seeds = static_cast<int>(judged.seeds.size());
  record.noiseRmse = noiseOver(judged.seeds);
  record.deterministic = judged.seeds.size() > 1 && record.noiseRmse == 0.0;
  record.parts = errorParts(judged.seeds, reference.mean, reference.variance, record.deterministic);
  std::vector<double> rmses{record.error.rmse.value};
  for (std::size_t seed = 1; seed < judged.seeds.size(); ++seed)
    rmses.push_back(rmseOf(judged.seeds[seed], reference.mean));
  record.rmseOverSeeds =
      record.deterministic || rmses.size() == 1 ? Measured{rmses.front(), 0.0} : meanOverSeeds(rmses);
  record.errorOfNothing = truth.errorOfNothing(layer);
  return record;
}

SceneSnapshot snapshotAt(const MeasureContext& context, const RenderOptions& options, double time) {
  return snapshotOf(context.scene, time, options.camera, options.width, options.height);
}

}  // namespace

FrameResult renderFiltered(PipelineExecutor& executor, const SceneSnapshot& centre, int positions,
                           int frameIndex) {
  // The truth is filtered over the pixel, so that with one sample at its centre the silhouettes of bright
  // lamps would outweigh every other error. The camera turns by the fraction of a pixel, which shifts the
  // picture but for second order.
  const int count = std::max(1, positions);
  const float pixel = 2.0f * centre.camera.tanHalfFov / static_cast<float>(centre.camera.height);
  // Unlike a regular grid, the sequence has as many different rows and columns as positions, which matters
  // where edges run along the rows. A single position is the centre.
  FrameResult sum;
  for (int position = 0; position < count; ++position) {
    SceneSnapshot shifted = centre;
    const auto [u, v] = r2Point(position);
    const glm::vec2 offset(u - 0.5, v - 0.5);
    CameraView& camera = shifted.camera;
    camera.forward =
        glm::normalize(camera.forward + pixel * (offset.x * camera.right + offset.y * camera.up));
    FrameResult frame = executor.render(shifted, frameIndex);
    if (position == 0) {
      sum = std::move(frame);
      continue;
    }
    if (sum.healthFindings.empty()) sum.healthFindings = std::move(frame.healthFindings);
    for (auto& [name, picture] : sum.outputs) {
      const std::vector<float>& added = frame.outputs.at(name).values();
      for (std::size_t i = 0; i < added.size(); ++i) picture.values()[i] += added[i];
    }
  }
  for (auto& [name, picture] : sum.outputs)
    for (float& value : picture.values()) value /= static_cast<float>(count);
  return sum;
}

bool flickers(const Scene& scene, const ReportOptions& options) {
  if (options.flickerPairs < 1) return false;
  const auto at = [&](double time) { return snapshotOf(scene, time, options.camera, 1, 1); };
  const Reads changed =
      whatChanged(scene, at(options.time), at(options.time + options.flickerPairs * kFlickerStep));
  return reads(changed, Reads::geometry) || reads(changed, Reads::lights) || reads(changed, Reads::camera) ||
         SceneTraits::of(scene).particles;
}

void measureErrors(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record) {
  RenderOptions options = renderOptions(context, record.point);
  std::vector<Judged> judged;
  for (int seed = 0; seed < std::max(1, context.options.seeds); ++seed) {
    options.seed = context.options.seed + static_cast<std::uint64_t>(seed);
    options.health = seed == 0;
    options.interactive = true;
    PipelineExecutor executor(context.device, context.techniques, context.scene, pipeline, options);
    FrameResult frame = renderFiltered(executor, snapshotAt(context, options, context.options.time),
                                       context.options.subpixels);
    if (seed == 0) {
      record.point.healthFindings = frame.healthFindings;
      record.point.notes = frame.notes;
    }
    collectOutputs(judged, executor, std::move(frame));
    // A technique without random numbers gives the same bits for every seed: two show it, more would only
    // cost time.
    if (seed == 1 && std::all_of(judged.begin(), judged.end(),
                                 [](const Judged& one) { return sameValues(one.seeds[0], one.seeds[1]); }))
      break;
  }

  for (const Judged& one : judged) {
    const auto [biasLayer, missLayer] = truthLayers(one.component);
    OutputPictures pictures;
    pictures.output = one.output;
    pictures.component = name(one.component);
    const float exposure = context.truth.exposure(missLayer);
    pictures.picture = encodePng(one.seeds.front(), exposure);
    for (const bool bias : {true, false}) {
      const std::string& layer = bias ? biasLayer : missLayer;
      const TruthLayer* reference = context.truth.layer(layer);
      if (reference == nullptr || (!bias && missLayer == biasLayer)) continue;
      if (!reference->mean.sameShape(one.seeds.front()))
        throw Error(fmt::format(
            "output '{}' has {} x {} pixels of {} channels, but its truth '{}' has {} x {} of {}", one.output,
            one.seeds.front().width(), one.seeds.front().height(), one.seeds.front().channels(), layer,
            reference->mean.width(), reference->mean.height(), reference->mean.channels()));
      ComponentError error = errorAgainst(one, context.truth, layer, bias);
      pictures.against.push_back(
          {layer, encodePng(falseColour(flipHdr(one.seeds.front(), reference->mean))), error.error.flip});
      record.point.errors.push_back(std::move(error));
    }
    record.pictures.push_back(std::move(pictures));
  }
}

void measureFlicker(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record) {
  if (record.point.errors.empty() || !flickers(context.scene, context.options)) return;
  RenderOptions options = renderOptions(context, record.point);
  options.interactive = true;
  PipelineExecutor executor(context.device, context.techniques, context.scene, pipeline, options);
  std::vector<Judged> judged;  // with frames in place of seeds
  for (int frame = 0; frame <= context.options.flickerPairs; ++frame)
    collectOutputs(
        judged, executor,
        renderFiltered(executor, snapshotAt(context, options, context.options.time + frame * kFlickerStep),
                       context.options.subpixels, frame));
  for (ComponentError& error : record.point.errors)
    for (const Judged& one : judged) {
      if (one.output != error.output) continue;
      std::vector<Picture> means, variances;
      for (int frame = 0; frame <= context.options.flickerPairs; ++frame) {
        const TruthLayer& layer = *context.truth.later(context.scene, frame).layer(error.truth);
        means.push_back(layer.mean);
        variances.push_back(layer.variance);
      }
      error.flicker = flicker(one.seeds, means, variances);
    }
}

void countWork(const TimingContext& context, const Pipeline& pipeline,
               const std::vector<DeviceCeiling>& ceilings, ReportPoint& point, const KeptOutputs& kept) {
  RenderOptions options = renderOptions(context, point);
  options.countWork = true;
  try {
    PipelineExecutor executor(context.device, context.techniques, context.scene, pipeline, options);
    for (const auto& [pass, port] : kept) executor.keepOutput(pass, port);
    FrameResult frame = executor.render(context.options.time, 0, PipelineExecutor::Pictures::no);
    for (PassRecord& pass : frame.passes) {
      point.passBounds[pass.name] = lowerBounds(pass.work, ceilings);
      point.passWork[pass.name] = std::move(pass.work);
    }
  } catch (const AbsentError& error) {
    point.whyNotCounted = error.what();
  }
}

struct TimedPoint::State {
  ReportPoint& point;
  double time;                        ///< s
  const std::uint64_t bytesOfOthers;  ///< of points that are timed at the same time
  PipelineExecutor executor;
  int nextFrames = 0;
  std::vector<double> frameMs, shares, nextMs;
  std::map<std::string, std::vector<double>> deviceMs, hostMs;

  State(const TimingContext& context, const Pipeline& pipeline, ReportPoint& pointToTime)
      : point(pointToTime),
        time(context.options.time),
        bytesOfOthers(context.device.allocatedBytes()),
        executor(context.device, context.techniques, context.scene, pipeline,
                 renderOptions(context, pointToTime)) {}
};

TimedPoint::TimedPoint(const TimingContext& context, const Pipeline& pipeline, ReportPoint& point,
                       const KeptOutputs& kept)
    : state_(std::make_unique<State>(context, pipeline, point)) {
  for (const auto& [pass, port] : kept) state_->executor.keepOutput(pass, port);
  const FrameResult frame = state_->executor.render(state_->time, 0, PipelineExecutor::Pictures::no);
  point.peakBytes = frame.peakBytes - state_->bytesOfOthers;
  for (const PassRecord& pass : frame.passes) {
    point.passOrder.push_back(pass.name);
    point.passBytes[pass.name] = pass.bytes;
  }
}

const PipelineExecutor& TimedPoint::executor() const {
  return state_->executor;
}

TimedPoint::~TimedPoint() = default;
TimedPoint::TimedPoint(TimedPoint&&) noexcept = default;

void TimedPoint::timeFrame() {
  State& s = *state_;
  s.executor.invalidate();
  const FrameResult frame = s.executor.render(s.time, 0, PipelineExecutor::Pictures::no);
  s.frameMs.push_back(frame.frameMs);
  if (frame.frameMs > 0.0) s.shares.push_back(frame.betweenPassesMs / frame.frameMs);
  for (const PassRecord& pass : frame.passes) s.hostMs[pass.name].push_back(pass.hostMs);
  // The passes in a frame of their own: their instruments are no part of the frame's time.
  s.executor.invalidate();
  s.executor.render(s.time, 0, PipelineExecutor::Pictures::no, PipelineExecutor::Timing::passes);
}

void TimedPoint::timeNextFrame() {
  constexpr double kNextFrame = 1.0 / 60.0;  // s
  State& s = *state_;
  ++s.nextFrames;
  s.nextMs.push_back(
      s.executor.render(s.time + s.nextFrames * kNextFrame, s.nextFrames, PipelineExecutor::Pictures::no)
          .frameMs);
}

void TimedPoint::finish() {
  State& s = *state_;
  for (const std::vector<PassRecord>& frame : s.executor.timedPasses())
    for (const PassRecord& pass : frame) s.deviceMs[pass.name].push_back(pass.deviceMs);
  s.point.frameMs = statisticsOf(s.frameMs);
  s.point.nextFrameMs = statisticsOf(s.nextMs);
  s.point.frameworkShare = s.shares.empty() ? 0.0 : statisticsOf(s.shares).median;
  for (const auto& [name, values] : s.deviceMs) s.point.passDeviceMs[name] = statisticsOf(values);
  for (const auto& [name, values] : s.hostMs) s.point.passHostMs[name] = statisticsOf(values);
}

void measureTimes(const TimingContext& context, const Pipeline& pipeline, PointRecord& record) {
  TimedPoint timed(context, pipeline, record.point);
  const int repeats = std::max(1, context.options.repeats);
  for (int repeat = 0; repeat < repeats; ++repeat) timed.timeFrame();
  for (int repeat = 0; repeat < repeats; ++repeat) timed.timeNextFrame();
  timed.finish();
}

}  // namespace lumivox::report
