// Runs a bound pipeline: the changes since the last frame decide which of the kept passes run again.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "pipeline/changes.h"
#include "pipeline/executor_state.h"
#include "pipeline/explain.h"
#include "pipeline/health.h"
#include "pipeline/text_values.h"

namespace lumivox {

namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Per pass, the largest number of bounces that it or one of its sources models. Outputs that need what the
/// scene does not have count for nothing, whether they are left out or not.
std::vector<int> bouncesOf(const BoundGraph& graph, const SceneTraits& traits) {
  const auto isMet = [&](Needs needs) { return unmetNeed(needs, traits).empty(); };
  std::vector<int> bounces(graph.passes.size(), 0);
  for (const int position : graph.order) {
    const auto index = static_cast<std::size_t>(position);
    const Pass& pass = *graph.passes[index].object;
    const std::vector<OutBase*>& outputs = pass.outputs();
    if (isMet(pass.needs()) && std::any_of(outputs.begin(), outputs.end(),
                                           [&](const OutBase* output) { return isMet(output->needs()); }))
      bounces[index] = pass.indirectBounces();
    for (const OutputIndex source : graph.passes[index].sources)
      if (source.valid() && isMet(graph.output(source).needs()))
        bounces[index] = std::max(bounces[index], bounces[static_cast<std::size_t>(source.pass)]);
  }
  return bounces;
}

}  // namespace

PipelineExecutor::State::State(gpu::Device& gpuDevice, TechniqueSource& source, const Scene& sceneToRender,
                               const Pipeline& text, const RenderOptions& renderOptions)
    : device(gpuDevice),
      techniques(source),
      scene(&sceneToRender),
      pipeline(text),
      options(renderOptions),
      graph(bindPipeline(pipeline, source, renderOptions.parameters)),
      context(gpuDevice, sceneToRender, renderOptions.keepEverything, renderOptions.transientMemory),
      timers(gpuDevice) {
  const gpu::Charging charging(device, account);
  scene->camera(options.camera);
  for (const BoundOutput& output : graph.outputs) outputNames.push_back(output.name);
  for (const std::string& wanted : options.wanted) {
    if (std::find(outputNames.begin(), outputNames.end(), wanted) != outputNames.end()) continue;
    const std::string nearest = nearestWord(wanted, outputNames);
    throw Error(fmt::format("pipeline \"{}\" has no output '{}'; expected {}{}", pipeline.name, wanted,
                            oneOf(outputNames, "none"),
                            nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  request.traits = context.traits();
  sceneTraits = SceneTraits::of(*scene);
  request.keepEverything = options.keepEverything;
  request.interactive = options.interactive;
  request.accumulate = options.accumulate;
  for (const std::string& output : outputNames) {
    const bool named =
        std::find(options.wanted.begin(), options.wanted.end(), output) != options.wanted.end();
    request.wanted.push_back(options.wantsOutputs && (options.wanted.empty() || named));
  }
  for (const std::string& name : pipeline.techniques()) {
    const Technique* technique = techniques.technique(name);
    if (!technique->shaders.technique.empty()) context.shaders().addPack(technique->shaders);
  }
  context.setSeed(options.seed);
  context.setInspects(options.health);
  context.setAccumulates(options.accumulate);
  if (options.countWork) context.shaders().countWork();
  if (options.checkReads) {
    RenderOptions plain = options;
    plain.checkReads = plain.health = plain.countWork = false;
    plain.transientMemory = nullptr;
    scratch = std::make_unique<PipelineExecutor>(device, techniques, *scene, pipeline, plain);
    plain.keepEverything = true;
    whole = std::make_unique<PipelineExecutor>(device, techniques, *scene, pipeline, plain);
    keepsOutputs = scratch->state_->keepsOutputs = true;
  }
}

namespace {

/// Whether the two plans give a pass different inputs or want different outputs of it.
bool planDiffers(const BoundPass& bound, std::size_t pass, const PrunePlan& before, const PrunePlan& after) {
  const PassPlan &a = before.passes[pass], &b = after.passes[pass];
  if (a.kept != b.kept) return true;
  for (std::size_t port = 0; port < b.outputs.size(); ++port)
    if (a.outputs[port].wanted != b.outputs[port].wanted) return true;
  return std::any_of(bound.sources.begin(), bound.sources.end(), [&](const OutputIndex source) {
    return source.valid() && before.output(source).wanted != after.output(source).wanted;
  });
}

}  // namespace

/// The wanted outputs of a pass decide which inputs it uses, and those decide which outputs of other passes
/// are wanted. So planning repeats until nothing more falls away.
PrunePlan PipelineExecutor::State::planFor(const PruneRequest& run) {
  for (const BoundPass& pass : graph.passes)
    for (OutBase* output : pass.object->outputs()) output->wanted_ = true;
  for (;;) {
    PrunePlan result = prune(graph, run);
    bool fewer = false;
    for (std::size_t pass = 0; pass < graph.passes.size(); ++pass) {
      const auto& outputs = graph.passes[pass].object->outputs();
      for (std::size_t port = 0; port < outputs.size(); ++port) {
        if (!outputs[port]->wanted_ || result.passes[pass].outputs[port].wanted) continue;
        outputs[port]->wanted_ = false;
        fewer = true;
      }
    }
    if (!fewer) return result;
  }
}

const PrunePlan& PipelineExecutor::State::planned() {
  if (plan) return *plan;
  plan = planFor(request);
  mustRun.resize(graph.passes.size(), false);
  for (std::size_t pass = 0; pass < graph.passes.size(); ++pass) {
    const auto& outputs = graph.passes[pass].object->outputs();
    for (std::size_t port = 0; port < outputs.size(); ++port) {
      OutputPlan& output = plan->passes[pass].outputs[port];
      if (!output.wanted) outputs[port]->reset();
      output.keep = output.keep || (keepsOutputs && output.wanted);
    }
    if (!plan->passes[pass].kept) context.memory().forgetKept(graph.passes[pass].name);
    if (earlierPlan && planDiffers(graph.passes[pass], pass, *earlierPlan, *plan)) mustRun[pass] = true;
  }
  if (options.accumulate) countedSources = sourcesThatCount();
  if (!earlierPlan) complete = false;
  earlierPlan.reset();
  return *plan;
}

void PipelineExecutor::State::forgetPlan() {
  plan.reset();
  earlierPlan.reset();
  complete = false;
  emptyHistories();
}

Reads PipelineExecutor::State::changesSince(const SceneSnapshot& snapshot, int frameIndex) const {
  Reads changed = announced;
  changed = changed | (last ? whatChanged(*scene, *last, snapshot) : ~Reads::history);
  if (lastFrameIndex && *lastFrameIndex != frameIndex) changed = changed | Reads::time;
  return options.accumulate ? changed | Reads::history : changed;
}

bool PipelineExecutor::State::readsWhatChanged(std::size_t pass, Reads changed,
                                               const SceneSnapshot& snapshot) const {
  const Pass& object = *graph.passes[pass].object;
  const Reads read = readsOf(graph.passes[pass]);
  if (reads(read, changed & ~Reads::partOfCamera)) return true;
  if (!reads(read, Reads::partOfCamera) || !reads(changed, Reads::camera)) return false;
  const auto before = lastOfCamera.find(pass);
  return before == lastOfCamera.end() || object.readsOfCamera(snapshot) != before->second;
}

namespace {

/// Connected outputs that a pass reads in the frame that made them.
std::vector<OutputIndex> sourcesNow(const BoundPass& pass) {
  std::vector<OutputIndex> result;
  for (std::size_t i = 0; i < pass.sources.size(); ++i)
    if (pass.sources[i].valid() && pass.object->inputs()[i]->presence() != Presence::history)
      result.push_back(pass.sources[i]);
  return result;
}

}  // namespace

/// Per pass of the graph: whether it runs. A pass runs if something that it reads changed, if one of its
/// sources runs, or if a value that such a pass needs was returned to the pool meanwhile.
std::vector<bool> PipelineExecutor::State::passesToRun(Reads changed, const SceneSnapshot& snapshot) const {
  const bool all = !complete || options.keepEverything;
  std::vector<bool> runs(graph.passes.size(), false);
  for (const int position : plan->order) {
    const auto index = static_cast<std::size_t>(position);
    runs[index] = all || mustRun[index] || readsWhatChanged(index, changed, snapshot);
    for (const OutputIndex source : sourcesNow(graph.passes[index])) {
      if (runs[static_cast<std::size_t>(source.pass)]) runs[index] = true;
    }
  }
  // Passes added from here on do not make their readers run: the same inputs give the same values again.
  for (std::size_t i = 0; i < graph.outputs.size(); ++i) {
    const OutputIndex source = graph.outputs[i].source;
    if (request.wanted[i] && plan->output(source).wanted && !graph.output(source).hasValue()) {
      runs[static_cast<std::size_t>(source.pass)] = true;
    }
  }
  for (auto index = plan->order.rbegin(); index != plan->order.rend(); ++index) {
    if (!runs[static_cast<std::size_t>(*index)]) continue;
    for (const OutputIndex source : sourcesRead(graph.passes[static_cast<std::size_t>(*index)], request)) {
      if (plan->output(source).wanted && !graph.output(source).hasValue()) {
        runs[static_cast<std::size_t>(source.pass)] = true;
      }
    }
  }
  return runs;
}

PipelineExecutor::State::Instrument PipelineExecutor::State::instrumentOf(Timing timing) const {
  if (timing == Timing::frame) return Instrument::none;
  return device.info().timerQueriesTrusted ? Instrument::stamps : Instrument::fence;
}

PipelineExecutor::State::Clock::time_point PipelineExecutor::State::startFrame(Instrument instrument) {
  // Frames timed by the device follow each other without a gap, so that the device never waits for the host.
  if (instrument != Instrument::stamps) device.finish();
  account->resetPeak();
  return Clock::now();
}

void PipelineExecutor::State::keepTimes(std::vector<PassRecord> passes) {
  for (const PassRecord& pass : passes) {
    if (pass.ran) lastMs[pass.name] = pass.deviceMs;
  }
  timed.push_back(std::move(passes));
}

void PipelineExecutor::State::readTimes(const std::vector<gpu::PassTimers::Frame>& frames) {
  for (const gpu::PassTimers::Frame& frame : frames) {
    std::vector<PassRecord> passes = std::move(awaited.front());
    awaited.erase(awaited.begin());
    auto time = frame.begin();
    for (PassRecord& pass : passes) {
      if (pass.ran && !pass.onHost) pass.deviceMs = *time++;
    }
    keepTimes(std::move(passes));
  }
}

void PipelineExecutor::State::runPass(std::size_t index, Instrument instrument, FrameResult& result) {
  const BoundPass& bound = graph.passes[index];
  PassRecord record{bound.name, bound.technique, bound.pass};
  if (options.countWork) context.shaders().takeWork();  // drops the work counted between the passes
  record.onHost = bound.object->worksOnHost();
  const bool stamped = instrument == Instrument::stamps && !record.onHost;
  const bool fenced = instrument != Instrument::none && !stamped;
  if (stamped) timers.begin();
  const gpu::Device::Elapsed elapsed =
      context.run(*bound.object, bound.name, fenced, stillFrames.empty() ? 0 : stillFrames[index]);
  if (stamped) timers.end();
  if (options.countWork) record.work = context.shaders().takeWork();
  record.hostMs = elapsed.hostMs;
  record.deviceMs = elapsed.deviceMs;
  record.bytes = context.bytesOfRun();
  const auto& outputs = bound.object->outputs();
  for (std::size_t port = 0; port < outputs.size(); ++port) {
    const bool wanted = plan->passes[index].outputs[port].wanted;
    // An unwanted output is absent for its readers even if the pass assigned it.
    if (!wanted) outputs[port]->reset();
    if (wanted && !outputs[port]->hasValue()) {
      throw Error(fmt::format("pass {}: it did not set its output '{}'", bound.name, outputs[port]->name()));
    }
  }
  lastRun[static_cast<int>(index)] = record;
  if (reads(bound.object->readsFrom(), Reads::partOfCamera))
    lastOfCamera[index] = bound.object->readsOfCamera(context.snapshot());
  result.passes.push_back(std::move(record));
}

/// Users expect everything in a scene to affect its image, as it does in the reference.
void PipelineExecutor::State::warnOfUnreadTraits(const SceneSnapshot& snapshot) const {
  Camera camera = scene->camera(options.camera);
  camera.aperture = snapshot.camera.aperture;
  for (const LeftOut& trait : unreadTraits({sceneTraits, *scene, camera}, graph, *plan, request))
    logWarning("pipeline \"{}\" leaves out {}: {}", pipeline.name, trait.what, trait.why);
}

FrameResult PipelineExecutor::State::frame(SceneSnapshot snapshot, int frameIndex, Images images,
                                           Timing timing, Clock::time_point start) {
  const gpu::Charging charging(device, account);
  planned();
  warnOfUnreadTraits(snapshot);
  const Reads changed = changesSince(snapshot, frameIndex);
  const bool otherSize =
      last && (last->camera.width != snapshot.camera.width || last->camera.height != snapshot.camera.height);
  if (interrupted || otherSize) emptyHistories();
  countStillFrames(changed, snapshot);
  announced = Reads::nothing;
  last = std::move(snapshot);
  lastFrameIndex = frameIndex;
  interrupted = true;  // until the frame is done

  const Instrument instrument = instrumentOf(timing);
  std::optional<FrameResult> result = attempt(changed, instrument, start);
  // An incomplete frame is rendered again. Nothing of it is kept, and the time of the frame includes all
  // attempts.
  while (!result) result = attempt(Reads::nothing, instrument, start);
  if (timing == Timing::passes) result->frameMs = std::numeric_limits<double>::quiet_NaN();
  if (options.accumulate) holdHistories();
  complete = true;
  interrupted = false;
  mustRun.assign(graph.passes.size(), false);
  if (instrument == Instrument::fence) keepTimes(result->passes);
  if (instrument == Instrument::stamps) readTimes(timers.take());
  if (options.checkReads) checkReads(*result);
  collectImages(*result, images);
  return *std::move(result);
}

std::optional<FrameResult> PipelineExecutor::State::attempt(Reads changed, Instrument instrument,
                                                            Clock::time_point start) {
  if (instrument == Instrument::stamps) timers.beginFrame();
  FrameResult result;
  const std::vector<bool> runs = passesToRun(changed, *last);
  context.pool().beginFrame();
  context.setFrame(*last, *lastFrameIndex, reads(changed, Reads::geometry));
  context.memory().abandonFrame();
  if (!complete) context.memory().forgetKept();
  // If an error ends this frame, no later frame may take its results for current.
  complete = false;
  for (const int index : plan->order) {
    if (!runs[static_cast<std::size_t>(index)]) continue;
    for (OutBase* output : graph.passes[static_cast<std::size_t>(index)].object->outputs()) output->reset();
  }

  double passesMs = 0.0, scanMs = 0.0;
  for (std::size_t position = 0; position < plan->order.size(); ++position) {
    const auto index = static_cast<std::size_t>(plan->order[position]);
    const BoundPass& bound = graph.passes[index];
    if (runs[index]) {
      const auto passStart = Clock::now();
      runPass(index, instrument, result);
      passesMs += millisecondsSince(passStart);
      if (options.health) {
        const auto scanStart = Clock::now();
        for (const OutBase* output : bound.object->outputs())
          scanHealth(bound.name, *output, result.healthFindings);
        scanMs += millisecondsSince(scanStart);
      }
    } else {
      PassRecord record{bound.name, bound.technique, bound.pass};
      record.ran = false;
      record.bytes = lastRun[static_cast<int>(index)].bytes;
      result.passes.push_back(std::move(record));
    }
    for (const OutputIndex source : sourcesNow(bound)) {
      const OutputPlan& output = plan->output(source);
      if (!output.keep && output.lastReader == static_cast<int>(position)) graph.output(source).reset();
    }
  }
  result.betweenPassesMs = millisecondsSince(start) - passesMs - scanMs;
  // Counts are read when the device is idle. Without counts, frames timed by stamps follow each other without
  // a gap.
  if (instrument != Instrument::stamps || context.hasCounts()) device.finish();
  const bool enough = context.allHadRoom();
  if (instrument == Instrument::stamps) {
    timers.endFrame();
    awaited.push_back(result.passes);
  }
  result.notes = context.takeNotes();
  if (!enough) {
    context.pool().endFrame();
    return std::nullopt;
  }
  result.frameMs = millisecondsSince(start) - scanMs;
  result.peakBytes = account->peakBytes();
  context.pool().endFrame(freesUnused);
  return result;
}

std::map<std::string, int> PipelineExecutor::State::indirectBounces() const {
  const std::vector<int> modelled = bouncesOf(graph, sceneTraits);
  std::map<std::string, int> bounces;
  for (const BoundOutput& bound : graph.outputs) {
    const Contributes component = graph.output(bound.source).contributes();
    const bool isIndirect = component == Contributes::indirectDiffuse ||
                            component == Contributes::indirectGlossy || component == Contributes::final;
    bounces[bound.name] = isIndirect ? std::max(1, modelled[static_cast<std::size_t>(bound.source.pass)]) : 1;
  }
  return bounces;
}

void PipelineExecutor::State::collectImages(FrameResult& result, Images images) {
  if (images == Images::yes && graph.outputs.empty() && request.forced.empty())
    throw Error(fmt::format("pipeline \"{}\" makes no image; expected output NAME pass.port", pipeline.name));
  const std::map<std::string, int> bounces = indirectBounces();
  for (std::size_t i = 0; i < graph.outputs.size(); ++i) {
    if (!request.wanted[i]) continue;
    const BoundOutput& bound = graph.outputs[i];
    const OutBase& output = graph.output(bound.source);
    result.components[bound.name] = output.contributes();
    result.indirectBounces[bound.name] = bounces.at(bound.name);
    if (images == Images::no) continue;
    if (!output.hasValue()) {
      result.outputs[bound.name] =
          neutralImage(last->camera.width, last->camera.height, output.contributes());
      continue;
    }
    ImageBuffer image = imageOf(output);
    if (image.width() != last->camera.width || image.height() != last->camera.height)
      throw Error(fmt::format(
          "output '{}' of pipeline \"{}\": {} has {} x {} texels; expected {} x {}, the image's size",
          bound.name, pipeline.name, graph.outputText(bound.source), image.width(), image.height(),
          last->camera.width, last->camera.height));
    result.outputs[bound.name] = std::move(image);
  }
}

// ---- public --------------------------------------------------------------------------------------------

PipelineExecutor::PipelineExecutor(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                                   const Pipeline& pipeline, const RenderOptions& options)
    : state_(new State(device, techniques, scene, pipeline, options)) {}

PipelineExecutor::~PipelineExecutor() = default;

FrameResult PipelineExecutor::render(double time, int frameIndex, Images images, Timing timing) {
  State& s = *state_;
  const auto start = s.startFrame(s.instrumentOf(timing));
  FrameResult result =
      s.frame(snapshotOf(*s.scene, time, s.options.camera, s.options.width, s.options.height), frameIndex,
              images, timing, start);
  s.tellOfStart(time);
  return result;
}

FrameResult PipelineExecutor::render(const SceneSnapshot& snapshot, int frameIndex, Images images,
                                     Timing timing) {
  State& s = *state_;
  return s.frame(snapshot, frameIndex, images, timing, s.startFrame(s.instrumentOf(timing)));
}

std::vector<std::vector<PassRecord>> PipelineExecutor::timedPasses() {
  State& s = *state_;
  if (!s.awaited.empty()) {
    s.device.finish();  // reports what the driver found wrong meanwhile
    s.readTimes(s.timers.takeAll());
  }
  return std::exchange(s.timed, {});
}

void PipelineExecutor::invalidate() {
  state_->complete = false;
}

void PipelineExecutor::emptyHistories() {
  state_->emptyHistories();
}

void PipelineExecutor::setParameters(const ParameterValues& values) {
  state_->setParameters(values);
}

void PipelineExecutor::setSeed(std::uint64_t seed) {
  State& s = *state_;
  if (seed == std::exchange(s.options.seed, seed)) return;
  s.context.setSeed(seed);
  s.mustRun.resize(s.graph.passes.size(), false);
  for (std::size_t pass = 0; pass < s.graph.passes.size(); ++pass) {
    const std::string& name = s.graph.passes[pass].name;
    if (!s.context.seeded().contains(name)) continue;
    s.mustRun[pass] = true;
    s.context.memory().forgetKept(name);
  }
  s.emptyHistories();
  s.forEachCheck([&](PipelineExecutor& check) { check.setSeed(seed); });
}

void PipelineExecutor::setHealth(bool health) {
  state_->options.health = health;
  state_->context.setInspects(health);
}

bool PipelineExecutor::readsSeed() const {
  return !state_->context.seeded().empty();
}

void PipelineExecutor::setScene(const Scene& scene) {
  state_->setScene(scene);
}

Explanation PipelineExecutor::explain() const {
  State& s = *state_;
  ExplainedRun run{s.graph,
                   s.planned(),
                   s.pipeline,
                   s.techniques,
                   s.context.shaders().usage(),
                   s.context.shaders().packs(),
                   s.context.reusedParts(),
                   {},
                   {s.sceneTraits, *s.scene, s.scene->camera(s.options.camera)},
                   s.request};
  s.readTimes(s.timers.takeAll());
  for (const auto& [index, record] : s.lastRun) {
    if (const auto ms = s.lastMs.find(record.name); ms != s.lastMs.end()) run.passMs[index] = ms->second;
  }
  run.keepEverything = s.options.keepEverything;
  run.poolBytes = s.context.pool().bytes();
  run.sharedBytes = s.context.pool().sharedBytes();
  return explainRun(run);
}

MemoryUse PipelineExecutor::memory() const {
  return {state_->account->bytes(), state_->account->sharedBytes()};
}

const std::vector<std::string>& PipelineExecutor::outputNames() const {
  return state_->outputNames;
}

shader::ShaderLibrary& PipelineExecutor::shaders() {
  return state_->context.shaders();
}

void PipelineExecutor::keepOutput(const std::string& pass, const std::string& port) {
  state_->request.forced.push_back(state_->graph.find(pass, port));
  state_->forgetPlan();
}

void PipelineExecutor::keepOnly(const std::string& pass, const std::string& port) {
  State& s = *state_;
  s.request.forced = {s.graph.find(pass, port)};
  for (const BoundPass& bound : s.graph.passes)
    for (OutBase* output : bound.object->outputs()) output->reset();
  s.forgetPlan();
}

void PipelineExecutor::freeUnused(bool free) {
  state_->freesUnused = free;
}

std::map<std::string, int> PipelineExecutor::indirectBounces() const {
  return state_->indirectBounces();
}

const Pass& PipelineExecutor::pass(const std::string& name) const {
  return *state_->graph.passes[state_->graph.findPass(name)].object;
}

const OutBase* PipelineExecutor::output(const std::string& pass, const std::string& port) const {
  const OutBase& output = state_->graph.output(state_->graph.find(pass, port));
  return output.hasValue() ? &output : nullptr;
}

}  // namespace lumivox
