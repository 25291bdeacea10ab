// The state that an executor carries from frame to frame, and its reaction to changed parameters or scenes.
#include <algorithm>

#include "lumivox/base/log.h"
#include "pipeline/changes.h"
#include "pipeline/executor_state.h"

namespace lumivox {

// ---- histories -----------------------------------------------------------------------------------------

std::vector<std::vector<OutputIndex>> PipelineExecutor::State::sourcesThatCount() {
  PruneRequest lean = request;
  lean.keepEverything = false;
  lean.traits = sceneTraits;
  const PrunePlan leanPlan = planFor(lean);
  std::vector<std::vector<OutputIndex>> result;
  for (const BoundPass& pass : graph.passes) {
    std::vector<OutputIndex> sources = sourcesRead(pass, lean);
    const std::vector<OutputIndex> before = historiesRead(pass, lean);
    sources.insert(sources.end(), before.begin(), before.end());
    std::erase_if(sources, [&](const OutputIndex source) { return !leanPlan.output(source).wanted; });
    result.push_back(std::move(sources));
  }
  for (std::size_t pass = 0; pass < graph.passes.size(); ++pass) {
    const auto& outputs = graph.passes[pass].object->outputs();
    for (std::size_t port = 0; port < outputs.size(); ++port)
      outputs[port]->wanted_ = plan->passes[pass].outputs[port].wanted;
  }
  return result;
}

void PipelineExecutor::State::countStillFrames(Reads changed, const SceneSnapshot& snapshot) {
  if (!options.accumulate) return;
  std::vector<bool> disturbed(graph.passes.size());
  for (std::size_t pass = 0; pass < graph.passes.size(); ++pass)
    disturbed[pass] = mustRun[pass] || readsWhatChanged(pass, changed & ~Reads::history, snapshot);
  // Histories lead back to earlier passes, so one round may not be enough.
  for (bool again = true; again;) {
    again = false;
    for (std::size_t pass = 0; pass < graph.passes.size(); ++pass) {
      if (disturbed[pass]) continue;
      const std::vector<OutputIndex>& sources = countedSources[pass];
      disturbed[pass] = std::any_of(sources.begin(), sources.end(), [&](const OutputIndex source) {
        return disturbed[static_cast<std::size_t>(source.pass)];
      });
      again = again || disturbed[pass];
    }
  }
  if (stillFrames.empty()) stillFrames.assign(graph.passes.size(), -1);
  for (std::size_t pass = 0; pass < graph.passes.size(); ++pass) {
    const bool accumulates = plan->passes[pass].kept && reads(readsOf(graph.passes[pass]), Reads::history);
    if (accumulates && disturbed[pass] && stillFrames[pass] > 0) startsAgain = graph.passes[pass].name;
    stillFrames[pass] = disturbed[pass] ? 0 : stillFrames[pass] + 1;
  }
}

void PipelineExecutor::State::tellOfStart(double time) {
  if (startsAgain.empty() || toldOfStart) return;
  logInformation(
      "pipeline \"{}\": pass {} accumulates from {:g} s on anew, since something that it depends on has changed, and after every further change",
      pipeline.name, startsAgain, time);
  toldOfStart = true;
}

void PipelineExecutor::State::holdHistories() {
  context.memory().commitFrame();
  for (const BoundPass& bound : graph.passes)
    for (InBase* input : bound.object->inputs())
      if (input->presence() == Presence::history) input->hold();
}

void PipelineExecutor::State::emptyHistories() {
  stillFrames.clear();
  context.memory().forgetHistories();
  for (const BoundPass& bound : graph.passes)
    for (InBase* input : bound.object->inputs()) input->forget();
  forEachCheck([](PipelineExecutor& check) { check.emptyHistories(); });
}

// ---- parameters ----------------------------------------------------------------------------------------

namespace {

bool sameParameters(const Pass& a, const Pass& b) {
  const auto& left = a.parameters();
  const auto& right = b.parameters();
  return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                    [](const ParamBase* x, const ParamBase* y) { return x->valueText() == y->valueText(); });
}

}  // namespace

template <class Begins>
void PipelineExecutor::State::replacePasses(BoundGraph next, const Begins& begins) {
  mustRun.resize(graph.passes.size(), false);
  for (std::size_t pass = 0; pass < graph.passes.size(); ++pass) {
    if (!begins(pass, *next.passes[pass].object)) {
      std::swap(graph.passes[pass].object, next.passes[pass].object);
      continue;
    }
    mustRun[pass] = true;
    context.memory().forgetKept(graph.passes[pass].name);
    lastOfCamera.erase(pass);
  }
  graph = std::move(next);
  connectInputs(graph);
}

void PipelineExecutor::State::setParameters(const ParameterValues& values) {
  // Binding anew finds every error before anything changes. Passes with unchanged parameters stay, with their
  // results; the others start like those of a new executor.
  BoundGraph next = bindPipeline(pipeline, techniques, values);
  options.parameters = values;
  forEachCheck([&](PipelineExecutor& check) { check.setParameters(values); });
  bool changes = false;
  replacePasses(std::move(next), [&](std::size_t pass, const Pass& after) {
    const bool begins = !sameParameters(*graph.passes[pass].object, after);
    changes = changes || begins;
    return begins;
  });
  if (!changes) return;
  emptyHistories();
  if (plan) earlierPlan = std::exchange(plan, std::nullopt);
}

void PipelineExecutor::State::renewPasses() {
  graph = bindPipeline(pipeline, techniques, options.parameters);
  lastRun.clear();
  lastOfCamera.clear();
  forgetPlan();
}

// ---- scene ---------------------------------------------------------------------------------------------

void PipelineExecutor::State::setScene(const Scene& next) {
  next.camera(options.camera);  // throws before anything changes
  const Reads changed = whatChanged(*scene, next);
  const bool otherObjects = scene->objects.size() != next.objects.size();
  scene = &next;
  context.setScene(next, reads(changed, Reads::geometry | Reads::materials | Reads::environment));
  forEachCheck([&](PipelineExecutor& check) { check.setScene(next); });
  const SceneTraits traits = SceneTraits::of(next);
  const bool otherTraits = std::exchange(sceneTraits, traits) != traits;
  if (changed == Reads::nothing && !otherTraits) return;
  // A pass may have cached facts of the scene, such as its connectivity or its largest triangle.
  replacePasses(bindPipeline(pipeline, techniques, options.parameters),
                [&](std::size_t pass, const Pass&) { return reads(readsOf(graph.passes[pass]), changed); });
  emptyHistories();
  announced = announced | changed;
  if (otherObjects) last.reset();
  if (!otherTraits) return;
  request.traits = context.traits();
  forgetPlan();
}

}  // namespace lumivox
