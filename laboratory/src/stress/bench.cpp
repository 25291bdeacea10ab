#include "stress/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <set>
#include <variant>

#include "experiment/measure.h"
#include "lumivox/base/error.h"
#include "lumivox/base/hash.h"
#include "lumivox/experiment/report.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/reference/path_tracer.h"
#include "lumivox/scene/text.h"
#include "stress/elsewhere.h"
#include "stress/pass_parameters.h"

namespace lumivox::stress {
namespace {

constexpr int kQuickPixels = 48, kFullPixels = 96;

/// A shot ready to run: the pipeline's text with the parameters of its passes, and the options.
struct Ready {
  Pipeline pipeline;
  RenderOptions options;
};

void requireHealthy(const FrameResult& frame) {
  if (frame.healthFindings.empty()) return;
  const std::size_t more = frame.healthFindings.size() - 1;
  throw Unhealthy(frame.healthFindings.front() +
                  (more == 0 ? std::string() : fmt::format(" (and {} more findings)", more)));
}

/// Lists have no order, so that the sorted items are hashed.
void addContent(Hasher& hasher, const VoxelList& list) {
  std::uint32_t count = 0;
  const std::vector<std::byte> word = list.count->download(0, sizeof(count));
  std::memcpy(&count, word.data(), sizeof(count));
  count = static_cast<std::uint32_t>(std::min<std::uint64_t>(count, list.capacity));
  hasher.add(count);
  if (count == 0) return;
  const std::vector<std::byte> bytes = list.items->download(0, count * list.itemBytes);
  std::vector<std::vector<std::uint32_t>> items(
      count, std::vector<std::uint32_t>(list.itemBytes / sizeof(std::uint32_t)));
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(items[i].data(), bytes.data() + i * list.itemBytes, list.itemBytes);
  std::sort(items.begin(), items.end());
  for (const std::vector<std::uint32_t>& item : items) hasher.bytes(item.data(), list.itemBytes);
}

/// Hashes textures and the lists that the kind declares. The meaning of other buffers is unknown.
void addContent(Hasher& hasher, const OutBase& output) {
  const PortContents contents = output.contents();
  std::vector<const gpu::Buffer*> added;
  for (const PortContents::Field& field : contents.fields())
    if (const auto* list = std::get_if<VoxelList>(&field.source))
      if (std::find(added.begin(), added.end(), list->items.get()) == added.end()) {
        addContent(hasher, *list);
        added.push_back(list->items.get());
      }
  for (const gpu::TextureRef& texture : output.textures())
    for (int level = 0; level < texture->description().levels; ++level) hasher.add(texture->download(level));
}

/// One image with the channels of all images in the order of their names.
ImageBuffer besideEachOther(const std::map<std::string, ImageBuffer>& images) {
  int channels = 0;
  for (const auto& [name, image] : images) channels += image.channels();
  if (channels == 0) return {};
  const ImageBuffer& first = images.begin()->second;
  ImageBuffer all(first.width(), first.height(), channels);
  int channel = 0;
  for (const auto& [name, image] : images)
    for (int own = 0; own < image.channels(); ++own, ++channel)
      for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) all.at(x, y, channel) = image.at(x, y, own);
  return all;
}

/// The finest voxel grids of the passes' outputs.
std::vector<VoxelBox> gridsOf(const PipelineExecutor& executor, const Pipeline& text) {
  std::vector<VoxelBox> grids;
  for (const PassText& pass : text.passes)
    for (const OutBase* port : executor.pass(pass.name).outputs()) {
      const OutBase* output = executor.output(pass.name, port->name());
      if (output == nullptr) continue;
      const PortContents contents = output->contents();
      if (contents.occupancy() != nullptr) grids.push_back(VoxelBox::of(contents.occupancy()->grid));
      for (const PortContents::Field& field : contents.fields())
        if (field.level == 0) grids.push_back(field.box);
    }
  return grids;
}

/// Draws voxels as seen along z; nearer ones are brighter.
ImageBuffer imageOf(const VoxelSet& voxels) {
  const glm::ivec3 size = voxels.resolution();
  ImageBuffer image(std::max(1, size.x), std::max(1, size.y), 1);
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x)
      for (int z = 0; z < size.z; ++z)
        if (voxels.contains({x, y, z})) {
          image.at(x, size.y - 1 - y, 0) = 1.0f - 0.9f * static_cast<float>(z) / static_cast<float>(size.z);
          break;
        }
  return image;
}

}  // namespace

ParameterValues batteryValues(const Pipeline& pipeline, bool quick) {
  ParameterValues values;
  for (const PipelineParameter& parameter : pipeline.parameters) values[parameter.name] = parameter.value;
  if (!quick || pipeline.sweeps.empty()) return values;
  const std::vector<ParameterValues> points = pipeline.sweeps.front().points();
  if (!points.empty())
    for (const auto& [name, value] : points.front())
      if (name != kAccumulatedFrames) values[name] = value;
  return values;
}

struct PipelineBench::State {
  Ground& ground;
  const Pipeline& pipeline;
  ParameterValues values;
  ImageBuffer last, given;
  bool isMetered = false;
  std::optional<double> exposure;  ///< that of the last scene rendered

  /// Finds a scene's exposure from a small reference, the same for all pipelines.
  void meter(const Scene& scene, const Shot& shot, double time);
  Ready ready(const Shot& shot) const;
  /// Keeps the outputs of the last pass where the pipeline declares none.
  void keepVoxels(PipelineExecutor& executor, const Pipeline& text) const;
  SceneSnapshot snapshot(const Scene& scene, const Ready& ready, double time) const {
    return snapshotOf(scene, time, ready.options.camera, ready.options.width, ready.options.height);
  }
  Frame frame(PipelineExecutor& executor, const SceneSnapshot& snapshot, const Shot& shot, int index);
  /// Voxels of the first output that has some; the image shows them from now on.
  std::optional<OccupiedVoxels> lookAtVoxels(const std::vector<const OutBase*>& outputs);
  std::vector<const OutBase*> lastOutputs(const PipelineExecutor& executor, const Pipeline& text) const;
  std::vector<Frame> sequence(PipelineExecutor& executor, const Scene& scene, const Ready& ready,
                              const std::vector<double>& times, const Shot& shot, const Edit& edit);
  std::uint64_t content(gpu::Device& device, const Scene& scene, const std::vector<double>& times,
                        const Shot& shot, const Edit& edit);
};

Ready PipelineBench::State::ready(const Shot& shot) const {
  Ready ready{shot.passParameters.empty() ? pipeline : withPassParameters(pipeline, shot.passParameters), {}};
  const int pixels = ground.quick ? kQuickPixels : kFullPixels;
  ready.options.parameters = values;
  for (const auto& [name, value] : shot.parameters)
    if (values.count(name) != 0) ready.options.parameters[name] = value;
  ready.options.width = shot.width > 0 ? shot.width : pixels;
  ready.options.height = shot.height > 0 ? shot.height : pixels;
  ready.options.seed = shot.seed;
  ready.options.camera = shot.camera;
  ready.options.keepEverything = shot.keepEverything;
  ready.options.accumulate = shot.accumulate;
  ready.options.health = true;
  return ready;
}

std::vector<const OutBase*> PipelineBench::State::lastOutputs(const PipelineExecutor& executor,
                                                              const Pipeline& text) const {
  std::vector<const OutBase*> outputs;
  const std::string& lastPass = text.passes.back().name;
  for (const OutBase* port : executor.pass(lastPass).outputs())
    if (const OutBase* output = executor.output(lastPass, port->name())) outputs.push_back(output);
  return outputs;
}

void PipelineBench::State::keepVoxels(PipelineExecutor& executor, const Pipeline& text) const {
  if (text.passes.empty()) throw Error(fmt::format("{}: the pipeline has no pass", text.file.string()));
  const std::string& lastPass = text.passes.back().name;
  for (const OutBase* port : executor.pass(lastPass).outputs()) executor.keepOutput(lastPass, port->name());
}

std::optional<OccupiedVoxels> PipelineBench::State::lookAtVoxels(const std::vector<const OutBase*>& outputs) {
  for (const OutBase* output : outputs)
    if (auto voxels = occupiedVoxels(*output)) {
      last = imageOf(voxels->voxels);
      return voxels;
    }
  return std::nullopt;
}

Frame PipelineBench::State::frame(PipelineExecutor& executor, const SceneSnapshot& snapshot, const Shot& shot,
                                  int index) {
  Frame frame;
  if (pipeline.outputs.empty()) {
    frame.result = executor.render(snapshot, index, PipelineExecutor::Images::no);
    frame.voxels = lookAtVoxels(lastOutputs(executor, pipeline));
  } else {
    frame.result = shot.subpixels > 1 ? experiment::renderFiltered(executor, snapshot, shot.subpixels, index)
                                      : executor.render(snapshot, index);
    frame.whole = compositeImage(frame.result);
    frame.compared = frame.whole.empty() ? besideEachOther(frame.result.outputs) : frame.whole;
    if (!frame.whole.empty())
      last = frame.whole;
    else if (!frame.result.outputs.empty())
      last = frame.result.outputs.begin()->second;
  }
  // Outputs other than light are drawn as fractions, like voxels.
  if (frame.whole.empty()) exposure.reset();
  if (shot.keepEverything) frame.grids = gridsOf(executor, pipeline);
  // Checked after the image, which shows the bad places.
  requireHealthy(frame.result);
  return frame;
}

void PipelineBench::State::meter(const Scene& scene, const Shot& shot, double time) {
  // Voxels are drawn as fractions.
  if (!isMetered || pipeline.outputs.empty()) return;
  const Ready made = ready(shot);
  ReferenceOptions view;
  view.width = made.options.width;
  view.height = made.options.height;
  view.camera = shot.camera;
  view.time = time;
  view.threads = 1;
  view.useCache = false;
  exposure.reset();
  try {
    exposure = viewExposure(scene, view);
  } catch (const Error&) {
    // A scene that the path tracer refuses has the exposure of its own image.
  }
}

PipelineBench::PipelineBench(Ground& ground, const Pipeline& pipeline)
    : state_(new State{ground, pipeline, batteryValues(pipeline, ground.quick), {}, {}, false, {}}) {}
PipelineBench::~PipelineBench() = default;

bool PipelineBench::quick() const {
  return state_->ground.quick;
}
const Pipeline& PipelineBench::pipeline() const {
  return state_->pipeline;
}
const PipelineParameter* PipelineBench::parameter(const std::string& name) const {
  for (const PipelineParameter& parameter : state_->pipeline.parameters)
    if (parameter.name == name) return &parameter;
  return nullptr;
}
TechniqueSource& PipelineBench::techniques() {
  return state_->ground.techniques;
}

Scene PipelineBench::sceneFromText(const std::string& text) const {
  return loadSceneText(text, state_->ground.scenes / "stress" / "made_by_a_case.scene",
                       state_->ground.sceneLoad);
}
Scene PipelineBench::committedScene(const std::string& name) const {
  return loadScene(state_->ground.scenes / (name + ".scene"), state_->ground.sceneLoad);
}

Frame PipelineBench::render(const Scene& scene, const Shot& shot) {
  State& s = *state_;
  const Ready ready = s.ready(shot);
  PipelineExecutor executor(s.ground.device, s.ground.techniques, scene, ready.pipeline, ready.options);
  if (s.pipeline.outputs.empty()) s.keepVoxels(executor, ready.pipeline);
  s.meter(scene, shot, shot.time);
  return s.frame(executor, s.snapshot(scene, ready, shot.time), shot, 0);
}

std::vector<Frame> PipelineBench::State::sequence(PipelineExecutor& executor, const Scene& scene,
                                                  const Ready& ready, const std::vector<double>& times,
                                                  const Shot& shot, const Edit& edit) {
  if (pipeline.outputs.empty()) keepVoxels(executor, ready.pipeline);
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < times.size(); ++i) {
    SceneSnapshot at = snapshot(scene, ready, times[i]);
    if (edit) edit(i, at);
    frames.push_back(frame(executor, at, shot, shot.firstFrame + static_cast<int>(i)));
  }
  return frames;
}

std::vector<Frame> PipelineBench::renderSequence(const Scene& scene, const std::vector<double>& times,
                                                 const Shot& shot, const Edit& edit) {
  State& s = *state_;
  Ready ready = s.ready(shot);
  ready.options.interactive = static_cast<bool>(edit);
  PipelineExecutor executor(s.ground.device, s.ground.techniques, scene, ready.pipeline, ready.options);
  if (!times.empty()) s.meter(scene, shot, times.back());
  return s.sequence(executor, scene, ready, times, shot, edit);
}

std::uint64_t PipelineBench::State::content(gpu::Device& device, const Scene& scene,
                                            const std::vector<double>& times, const Shot& shot,
                                            const Edit& edit) {
  Ready made = ready(shot);
  made.options.interactive = static_cast<bool>(edit);
  PipelineExecutor executor(device, ground.techniques, scene, made.pipeline, made.options);
  const Frame rendered = sequence(executor, scene, made, times, shot, edit).back();
  Hasher hasher;
  for (const auto& [name, image] : rendered.result.outputs) hasher.add(name).add(image.values());
  if (pipeline.outputs.empty())
    for (const OutBase* output : lastOutputs(executor, made.pipeline)) addContent(hasher, *output);
  return hasher.finish().low;
}

std::uint64_t PipelineBench::contentOf(const Scene& scene, const Shot& shot) {
  return state_->content(state_->ground.device, scene, {shot.time}, shot, {});
}

std::uint64_t PipelineBench::contentOfSequence(const Scene& scene, const std::vector<double>& times,
                                               const Shot& shot, const Edit& edit) {
  return state_->content(state_->ground.device, scene, times, shot, edit);
}

std::uint64_t PipelineBench::contentOnSecondDevice(const Scene& scene, const Shot& shot) {
  gpu::Device device(state_->ground.deviceOptions);
  return state_->content(device, scene, {shot.time}, shot, {});
}

std::uint64_t PipelineBench::contentElsewhere(const std::string& committedScene, const Shot& shot,
                                              const std::vector<std::string>& environment) {
  return askForContent(state_->ground, {state_->pipeline.file, committedScene, state_->ground.quick, shot},
                       environment);
}

std::optional<VoxelError> PipelineBench::voxelError(const Scene& scene, const Shot& shot) {
  State& s = *state_;
  const Ready ready = s.ready(shot);
  if (ready.pipeline.passes.empty()) return std::nullopt;
  PipelineExecutor executor(s.ground.device, s.ground.techniques, scene, ready.pipeline, ready.options);
  s.keepVoxels(executor, ready.pipeline);
  const SceneSnapshot snapshot = s.snapshot(scene, ready, shot.time);
  requireHealthy(executor.render(snapshot, 0, PipelineExecutor::Images::no));
  const auto voxels = s.lookAtVoxels(s.lastOutputs(executor, ready.pipeline));
  if (!voxels) return std::nullopt;
  return compareVoxels(voxels->voxels, trueVoxels(scene, snapshot, voxels->grid));
}

LayeredImage PipelineBench::reference(const Scene& scene, const Shot& shot, int samplesPerPixel,
                                      int threads) {
  const Ready ready = state_->ready(shot);
  ReferenceOptions options;
  options.samplesPerPixel = samplesPerPixel;
  options.seed = shot.seed;
  options.time = shot.time;
  options.camera = shot.camera;
  options.width = ready.options.width;
  options.height = ready.options.height;
  options.threads = threads;
  options.progress = false;
  const Ground& ground = state_->ground;
  const PipelineExecutor executor(ground.device, ground.techniques, scene, ready.pipeline, ready.options);
  std::set<int> layers;
  for (const auto& [output, bounces] : executor.indirectBounces())
    if (bounces > 1) layers.insert(bounces);
  options.bounceLayers.assign(layers.begin(), layers.end());
  return threads > 0 ? renderReference(scene, options) : cachedReference(scene, options);
}

void PipelineBench::show(const ImageBuffer& image) {
  // Channels of several images together make no image to look at.
  if (image.channels() == 1 || image.channels() == 3) state_->given = image;
}

void PipelineBench::meterScenes() {
  state_->isMetered = true;
}

double PipelineBench::exposure() const {
  return state_->exposure.value_or(displayExposure(shown()));
}

const ImageBuffer& PipelineBench::shown() const {
  return state_->given.empty() ? state_->last : state_->given;
}

}  // namespace lumivox::stress
