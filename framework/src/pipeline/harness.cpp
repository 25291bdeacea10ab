// One pass alone, on inputs made by a test.
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "pipeline/context.h"
#include "pipeline/graph.h"

namespace lumivox {

namespace {

/// Owns outputs that replace the sources of the pass under test.
class SourceHolder : public Pass {
 public:
  void run(PassContext&) override {}
};

}  // namespace

struct PassHarness::State {
  FrameContext context;
  SourceHolder holder;
  std::unique_ptr<Pass> pass;
  std::string name;
  std::vector<std::unique_ptr<OutBase>> sources;
  bool accumulates = false;
  int runs = 0;  ///< runs since accumulation began

  State(gpu::Device& device, const Scene& scene) : context(device, scene, false) {}
};

PassHarness::PassHarness(gpu::Device& device, TechniqueSource& techniques, const std::string& technique,
                         const std::string& pass, const Scene& scene, const SceneSnapshot& snapshot)
    : state_(new State(device, scene)) {
  const Technique* found = techniques.technique(technique);
  if (found == nullptr) {
    const MissingTechnique missing = explainMissing(techniques, technique);
    throw Error(missing.what + (missing.expected.empty() ? "" : "; expected " + missing.expected));
  }
  const PassEntry* entry = found->find(pass);
  if (entry == nullptr) throw Error(fmt::format("technique '{}' has no pass '{}'", technique, pass));
  state_->pass = entry->make();
  state_->name = pass;
  if (!found->shaders.technique.empty()) state_->context.shaders().addPack(found->shaders);
  state_->context.setFrame(snapshot, 0, true);
}

PassHarness::~PassHarness() = default;

Pass& PassHarness::pass() {
  return *state_->pass;
}

namespace {

ParamBase& parameterNamed(Pass& pass, const std::string& name) {
  for (ParamBase* parameter : pass.parameters()) {
    if (parameter->name() == name) return *parameter;
  }
  throw Error(fmt::format("the pass has no parameter '{}'", name));
}

void require(const std::string& parameter, const std::string& misfit) {
  if (!misfit.empty()) throw Error(fmt::format("parameter '{}' {}", parameter, misfit));
}

}  // namespace

void PassHarness::setParameter(const std::string& name, double value) {
  state_->context.memory().forgetKept();
  ParamBase& parameter = parameterNamed(*state_->pass, name);
  require(name, parameter.set(value));
  parameter.state();
}
void PassHarness::setParameter(const std::string& name, const std::string& word) {
  state_->context.memory().forgetKept();
  ParamBase& parameter = parameterNamed(*state_->pass, name);
  require(name, parameter.set(word));
  parameter.state();
}

Pass& PassHarness::holder() {
  return state_->holder;
}

void PassHarness::connectInput(const std::string& name, std::unique_ptr<OutBase> source) {
  for (InBase* input : state_->pass->inputs()) {
    if (input->name() != name) continue;
    if (!input->takes(source->kind())) {
      throw Error(fmt::format("input '{}' takes {}, not {}", name, input->kind().name, source->kind().name));
    }
    input->connect(source.get());
    if (input->presence() == Presence::history) input->hold();
    state_->sources.push_back(std::move(source));
    return;
  }
  throw Error(fmt::format("the pass has no input '{}'", name));
}

OutBase& PassHarness::outputNamed(const std::string& name) {
  for (OutBase* output : state_->pass->outputs()) {
    if (output->name() != name) continue;
    if (!output->hasValue())
      throw Error(fmt::format("output '{}' has no value: the pass has not run, or did not set it", name));
    return *output;
  }
  throw Error(fmt::format("the pass has no output '{}'", name));
}

void PassHarness::keepOnly(const std::string& output) {
  const std::vector<OutBase*>& outputs = state_->pass->outputs();
  if (std::none_of(outputs.begin(), outputs.end(), [&](const OutBase* one) { return one->name() == output; }))
    throw Error(fmt::format("the pass has no output '{}'", output));
  for (OutBase* one : outputs) one->wanted_ = one->name() == output;
}

void PassHarness::run(std::uint64_t seed) {
  for (const InBase* input : state_->pass->inputs()) {
    if (input->presence() == Presence::required && !input->present()) {
      throw Error(fmt::format("required input '{}' was not set", input->name()));
    }
  }
  std::string contradiction = state_->pass->applyPublished();
  if (contradiction.empty()) contradiction = state_->pass->checkParameters();
  if (!contradiction.empty()) throw Error(contradiction);
  state_->context.setSeed(seed);
  FrameContext& context = state_->context;
  bool again = false;
  do {
    for (OutBase* output : state_->pass->outputs()) output->reset();
    context.memory().abandonFrame();
    if (again || !state_->accumulates) context.memory().forgetKept();
    context.pool().beginFrame();
    context.run(*state_->pass, state_->name, /*fenced=*/false, state_->runs);
    context.pool().endFrame();
    context.device().finish();
    again = !context.allHadRoom();
  } while (again);
  if (!state_->accumulates) return;
  context.memory().commitFrame();
  ++state_->runs;
}

void PassHarness::accumulate() {
  state_->accumulates = true;
  state_->context.setAccumulates(true);
}

PassContext& PassHarness::context() {
  return state_->context;
}

}  // namespace lumivox
