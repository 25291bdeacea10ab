// Measures what leaving out saves; composes the whole image of a pipeline.
#include <cmath>
#include <cstring>

#include "lumivox/base/error.h"
#include "lumivox/experiment/report.h"

namespace lumivox {
namespace {

bool sameBits(const ImageBuffer& a, const ImageBuffer& b) {
  return a.sameShape(b) && (a.values().empty() || std::memcmp(a.values().data(), b.values().data(),
                                                              a.values().size() * sizeof(float)) == 0);
}

bool sameBits(const FrameResult& a, const FrameResult& b) {
  if (a.outputs.size() != b.outputs.size()) return false;
  for (const auto& [name, image] : a.outputs) {
    const auto other = b.outputs.find(name);
    if (other == b.outputs.end() || !sameBits(image, other->second)) return false;
  }
  return true;
}

/// Times of several frames of one executor in which every pass runs. Passes are timed in frames of their own,
/// since their instruments cost time.
struct Series {
  PipelineExecutor& executor;
  double time;  ///< s
  std::vector<double> frameMs{};

  void add() {
    using Timing = PipelineExecutor::Timing;
    for (const Timing timing : {Timing::frame, Timing::passes}) {
      executor.invalidate();
      const FrameResult frame = executor.render(time, 0, PipelineExecutor::Images::no, timing);
      if (timing == Timing::frame) frameMs.push_back(frame.frameMs);
    }
  }
  std::map<std::string, TimingStatistics> passStatistics() const {
    std::map<std::string, std::vector<double>> passMs;
    for (const std::vector<PassRecord>& frame : executor.timedPasses()) {
      for (const PassRecord& pass : frame)
        if (pass.ran) passMs[pass.name].push_back(pass.deviceMs);
    }
    std::map<std::string, TimingStatistics> statistics;
    for (const auto& [name, values] : passMs) statistics[name] = statisticsOf(values);
    return statistics;
  }
};

}  // namespace

PruningRecord measurePruning(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                             const Pipeline& pipeline, RenderOptions options, double time, int repeats) {
  options.health = false;
  options.keepEverything = false;
  PipelineExecutor pruned(device, techniques, scene, pipeline, options);
  options.keepEverything = true;
  PipelineExecutor unpruned(device, techniques, scene, pipeline, options);

  PruningRecord record;
  record.scene = scene.file.string();
  record.pipeline = pipeline.file.string();
  // The warm-up frames give the images and the bytes of each pass.
  {
    const FrameResult prunedFrame = pruned.render(time);
    const FrameResult unprunedFrame = unpruned.render(time);
    record.sameImage = sameBits(prunedFrame, unprunedFrame);
    for (const PassRecord& pass : prunedFrame.passes) record.prunedPassBytes[pass.name] = pass.bytes;
    for (const PassRecord& pass : unprunedFrame.passes) {
      record.unprunedPassBytes[pass.name] = pass.bytes;
      record.passOrder.push_back(pass.name);
    }
  }
  // The two take turns, so that a machine that becomes slower or faster does so for both.
  Series prunedSeries{pruned, time}, unprunedSeries{unpruned, time};
  for (int repeat = 0; repeat < repeats; ++repeat) {
    prunedSeries.add();
    unprunedSeries.add();
  }
  record.explanation = pruned.explain();  // taken here, where the memory is that of a whole frame
  record.prunedBytes = record.explanation.poolBytes;
  record.unprunedBytes = unpruned.explain().poolBytes;
  for (LeftOut& leftOut : record.explanation.leftOut) {
    const auto bytes = record.unprunedPassBytes.find(leftOut.pass);
    if (leftOut.level != LeftOut::Level::pass || leftOut.savedBytes != 0) continue;
    if (bytes != record.unprunedPassBytes.end() && record.prunedPassBytes.count(leftOut.pass) == 0)
      leftOut.savedBytes = bytes->second;
  }
  if (repeats <= 0) return record;

  // Following frames: time goes on and the camera moves by a thousandth of the scene, as in an interactive
  // walk. With a still camera a static scene would leave nothing to do, which says little.
  options.keepEverything = false;
  options.interactive = true;
  PipelineExecutor walking(device, techniques, scene, pipeline, options);
  walking.render(time, 0, PipelineExecutor::Images::no);
  std::vector<double> nextPruned, nextUnpruned;
  for (int repeat = 1; repeat <= repeats; ++repeat) {
    constexpr double kNextFrame = 1.0 / 60.0;  // s
    constexpr float kStride = 1e-3f;
    SceneSnapshot next =
        snapshotOf(scene, time + repeat * kNextFrame, options.camera, options.width, options.height);
    const float diagonal = next.bounds.empty ? 1.0f : glm::length(next.bounds.high - next.bounds.low);
    next.camera.eye += next.camera.right * (static_cast<float>(repeat) * kStride * diagonal);
    nextPruned.push_back(walking.render(next, repeat, PipelineExecutor::Images::no).frameMs);
    nextUnpruned.push_back(unpruned.render(next, repeat, PipelineExecutor::Images::no).frameMs);
  }
  record.nextPrunedMs = statisticsOf(std::move(nextPruned));
  record.nextUnprunedMs = statisticsOf(std::move(nextUnpruned));
  record.prunedMs = statisticsOf(prunedSeries.frameMs);
  record.unprunedMs = statisticsOf(unprunedSeries.frameMs);
  record.prunedPassMs = prunedSeries.passStatistics();
  record.unprunedPassMs = unprunedSeries.passStatistics();

  for (LeftOut& leftOut : record.explanation.leftOut) {
    const auto unprunedTime = record.unprunedPassMs.find(leftOut.pass);
    if (leftOut.level != LeftOut::Level::pass || unprunedTime == record.unprunedPassMs.end()) continue;
    if (record.prunedPassMs.count(leftOut.pass) != 0) continue;
    leftOut.savedMs = unprunedTime->second.median;
  }
  return record;
}

ImageBuffer compositeImage(const FrameResult& frame) {
  const auto named = frame.outputs.find("final");
  if (named != frame.outputs.end()) return named->second;
  for (const auto& [name, component] : frame.components)
    if (component == Contributes::final)
      if (const auto found = frame.outputs.find(name); found != frame.outputs.end()) return found->second;

  ImageBuffer sum;
  for (const auto& [name, image] : frame.outputs) {
    const auto component = frame.components.find(name);
    if (component == frame.components.end() || image.empty()) continue;
    const bool radiance =
        component->second == Contributes::direct || component->second == Contributes::indirectDiffuse ||
        component->second == Contributes::indirectGlossy || component->second == Contributes::scattered;
    if (!radiance) continue;
    if (sum.empty()) {
      sum = image;
      continue;
    }
    if (!sum.sameShape(image))
      throw Error("output '" + name + "': its image differs from the others in size or number of channels");
    for (std::size_t i = 0; i < sum.values().size(); ++i) sum.values()[i] += image.values()[i];
  }
  return sum;
}

}  // namespace lumivox
