#include "pipeline/prune.h"

#include <fmt/format.h>

#include <algorithm>

namespace lumivox {

namespace {

constexpr std::uint32_t bits(Reads set) {
  return static_cast<std::uint32_t>(set);
}

/// Goes forward through the pipeline and finds the outputs that can differ from their neutral element in this
/// scene.
class Availability {
 public:
  Availability(const BoundGraph& graph, const PruneRequest& request, PrunePlan& plan)
      : graph_(graph), request_(request), plan_(plan) {}

  /// Per pass and output.
  std::vector<std::vector<bool>> run() {
    available_.resize(graph_.passes.size());
    for (const int index : graph_.order) visit(static_cast<std::size_t>(index));
    return std::move(available_);
  }

 private:
  void visit(std::size_t index) {
    const BoundPass& bound = graph_.passes[index];
    PassPlan& pass = plan_.passes[index];
    const auto& outputs = bound.object->outputs();
    available_[index].assign(outputs.size(), true);
    if (request_.keepEverything) return;

    pass.why = whyImpossible(bound);
    bool any = false;
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const std::string need = unmetNeed(outputs[i]->needs(), request_.traits);
      if (!need.empty()) pass.outputs[i].why = fmt::format("needs {}, which the scene does not have", need);
      available_[index][i] = pass.why.empty() && need.empty();
      pass.outputs[i].impossible = !available_[index][i];
      pass.outputs[i].lacksNeed = !need.empty() || !unmetNeed(bound.object->needs(), request_.traits).empty();
      any = any || available_[index][i];
    }
    if (pass.why.empty() && !any && !outputs.empty())
      pass.why = "every output of it " + pass.outputs.front().why;
    if (pass.why.empty()) return;
    for (OutputPlan& output : pass.outputs) {
      if (output.why.empty()) output.why = "its pass was left out";
    }
  }

  std::string whyImpossible(const BoundPass& bound) const {
    if (const std::string need = unmetNeed(bound.object->needs(), request_.traits); !need.empty()) {
      return fmt::format("needs {}, which the scene does not have", need);
    }
    for (std::size_t i = 0; i < bound.sources.size(); ++i) {
      const InBase& input = *bound.object->inputs()[i];
      const OutputIndex source = bound.sources[i];
      if (input.presence() != Presence::required || !source.valid() || !bound.object->uses(input)) continue;
      if (!available_[static_cast<std::size_t>(source.pass)][static_cast<std::size_t>(source.port)]) {
        return fmt::format("its input '{}' comes from '{}', which was left out", input.name(),
                           graph_.outputText(source));
      }
    }
    return {};
  }

  const BoundGraph& graph_;
  const PruneRequest& request_;
  PrunePlan& plan_;
  std::vector<std::vector<bool>> available_;
};

std::vector<OutputIndex> inputsRead(const BoundPass& pass, const PruneRequest& request, bool histories) {
  std::vector<OutputIndex> result;
  for (std::size_t i = 0; i < pass.sources.size(); ++i) {
    const InBase& input = *pass.object->inputs()[i];
    if (!pass.sources[i].valid() || (input.presence() == Presence::history) != histories) continue;
    const bool ofUse = request.keepEverything ||
                       (unmetNeed(input.needs(), request.traits).empty() && pass.object->uses(input));
    if (ofUse) result.push_back(pass.sources[i]);
  }
  return result;
}

/// Why an output is not wanted: its kept reader does not use it with these parameters and wanted outputs, or
/// it has no reader.
std::string whyUnwanted(const BoundGraph& graph, const PrunePlan& plan, std::size_t pass, int port) {
  for (std::size_t reader = 0; reader < graph.passes.size(); ++reader) {
    const BoundPass& bound = graph.passes[reader];
    for (std::size_t i = 0; i < bound.sources.size(); ++i) {
      const OutputIndex source = bound.sources[i];
      if (source.pass != static_cast<int>(pass) || (port >= 0 && source.port != port)) continue;
      const PassPlan& read = plan.passes[reader];
      if (!read.kept || bound.object->uses(*bound.object->inputs()[i])) continue;
      const bool wantsAll = std::all_of(read.outputs.begin(), read.outputs.end(),
                                        [](const OutputPlan& output) { return output.wanted; });
      return fmt::format("the parameters of '{}'{} make its input '{}' useless", bound.name,
                         wantsAll ? "" : " and what is wanted of it", bound.object->inputs()[i]->name());
    }
  }
  return "nothing that is wanted depends on it";
}

void markWanted(const BoundGraph& graph, const PruneRequest& request,
                const std::vector<std::vector<bool>>& available, PrunePlan& plan) {
  const auto want = [&](OutputIndex index) {
    if (available[static_cast<std::size_t>(index.pass)][static_cast<std::size_t>(index.port)])
      plan.output(index).wanted = true;
  };
  for (std::size_t i = 0; i < graph.outputs.size(); ++i) {
    if (request.wanted[i] || request.keepEverything) want(graph.outputs[i].source);
  }
  for (const OutputIndex forced : request.forced) want(forced);

  // Goes backward: a pass with a wanted output is kept and wants its sources. A history may want an output of
  // a later pass, whose sources need another round.
  for (bool again = true; again;) {
    again = false;
    for (auto index = graph.order.rbegin(); index != graph.order.rend(); ++index) {
      const BoundPass& bound = graph.passes[static_cast<std::size_t>(*index)];
      PassPlan& pass = plan.passes[static_cast<std::size_t>(*index)];
      const bool before = pass.kept;
      for (OutputPlan& output : pass.outputs) {
        output.wanted = output.wanted || request.keepEverything;
        pass.kept = pass.kept || output.wanted;
      }
      pass.kept = pass.kept || request.keepEverything;
      if (!pass.kept) continue;
      for (const OutputIndex source : sourcesRead(bound, request)) want(source);
      for (const OutputIndex source : historiesRead(bound, request)) want(source);
      again = again || (!before && !historiesRead(bound, request).empty());
    }
  }
  for (std::size_t index = 0; index < plan.passes.size(); ++index) {
    PassPlan& pass = plan.passes[index];
    if (!pass.kept && pass.why.empty()) pass.why = whyUnwanted(graph, plan, index, -1);
    for (std::size_t port = 0; pass.kept && port < pass.outputs.size(); ++port) {
      OutputPlan& output = pass.outputs[port];
      if (!output.wanted && output.why.empty())
        output.why = whyUnwanted(graph, plan, index, static_cast<int>(port));
    }
  }
}

Reads whatMayChange(const PruneRequest& request) {
  const Reads camera = Reads::camera | Reads::partOfCamera;
  const Reads histories = request.accumulate ? Reads::history : Reads::nothing;
  if (request.interactive)
    return Reads::geometry | Reads::lights | camera | Reads::lens | Reads::time | Reads::capture | histories;
  Reads result = Reads::time | histories;
  if (request.traits.movingGeometry) result = result | Reads::geometry;
  if (request.traits.movingLights || (request.traits.movingGeometry && request.traits.areaLights > 0))
    result = result | Reads::lights;
  if (request.traits.movingCamera) result = result | camera;
  if (request.traits.movingCaptures) result = result | Reads::capture;
  return result;
}

/// How long each output must live.
void planLifetimes(const BoundGraph& graph, const PruneRequest& request, PrunePlan& plan) {
  for (const int index : graph.order) {
    if (plan.passes[static_cast<std::size_t>(index)].kept) plan.order.push_back(index);
  }
  for (std::size_t position = 0; position < plan.order.size(); ++position) {
    const std::size_t index = static_cast<std::size_t>(plan.order[position]);
    PassPlan& pass = plan.passes[index];
    pass.dependsOn = readsOf(graph.passes[index]);
    if (!request.accumulate) pass.dependsOn = pass.dependsOn & ~Reads::history;
    for (const OutputIndex source : sourcesRead(graph.passes[index], request)) {
      if (!plan.output(source).wanted) continue;
      pass.dependsOn = pass.dependsOn | plan.passes[static_cast<std::size_t>(source.pass)].dependsOn;
      plan.output(source).lastReader = static_cast<int>(position);
    }
    for (const OutputIndex source : historiesRead(graph.passes[index], request)) {
      if (plan.output(source).wanted) plan.output(source).keep = true;
    }
  }
  // A reader may run again without its source, if a change affects the reader alone: the source's output must
  // stay.
  for (const int index : plan.order) {
    const PassPlan& reader = plan.passes[static_cast<std::size_t>(index)];
    for (const OutputIndex source : sourcesRead(graph.passes[static_cast<std::size_t>(index)], request)) {
      if (!plan.output(source).wanted) continue;
      const std::uint32_t more =
          bits(reader.dependsOn) & ~bits(plan.passes[static_cast<std::size_t>(source.pass)].dependsOn);
      if ((more & bits(plan.mayChange)) != 0) plan.output(source).keep = true;
    }
  }
  for (std::size_t i = 0; i < graph.outputs.size(); ++i) {
    OutputPlan& output = plan.output(graph.outputs[i].source);
    if (request.wanted[i] && output.wanted) output.keep = true;
  }
  for (const OutputIndex forced : request.forced) plan.output(forced).keep = true;
  if (!request.keepEverything) return;
  for (PassPlan& pass : plan.passes) {
    for (OutputPlan& output : pass.outputs) output.keep = true;
  }
}

}  // namespace

Reads readsOf(const BoundPass& pass) {
  Reads result = pass.object->readsFrom();
  for (std::size_t i = 0; i < pass.sources.size(); ++i)
    if (pass.sources[i].valid() && pass.object->inputs()[i]->presence() == Presence::history)
      result = result | Reads::history;
  return result;
}

std::vector<OutputIndex> sourcesRead(const BoundPass& pass, const PruneRequest& request) {
  return inputsRead(pass, request, /*histories=*/false);
}

std::vector<OutputIndex> historiesRead(const BoundPass& pass, const PruneRequest& request) {
  return request.accumulate ? inputsRead(pass, request, /*histories=*/true) : std::vector<OutputIndex>{};
}

PrunePlan prune(const BoundGraph& graph, const PruneRequest& request) {
  PrunePlan plan;
  plan.mayChange = whatMayChange(request);
  plan.passes.resize(graph.passes.size());
  for (std::size_t i = 0; i < graph.passes.size(); ++i) {
    plan.passes[i].outputs.resize(graph.passes[i].object->outputs().size());
  }
  const auto available = Availability(graph, request, plan).run();
  markWanted(graph, request, available, plan);
  planLifetimes(graph, request, plan);
  return plan;
}

std::string readsText(Reads set) {
  std::vector<const char*> words;
  if (reads(set, Reads::geometry)) words.push_back("geometry");
  if (reads(set, Reads::materials)) words.push_back("materials");
  if (reads(set, Reads::lights)) words.push_back("lights");
  if (reads(set, Reads::camera)) words.push_back("camera");
  if (reads(set, Reads::lens)) words.push_back("the camera's lens");
  if (reads(set, Reads::partOfCamera)) words.push_back("part of the camera");
  if (reads(set, Reads::environment)) words.push_back("environment");
  if (reads(set, Reads::media)) words.push_back("media");
  if (reads(set, Reads::capture)) words.push_back("captured frames");
  if (reads(set, Reads::time)) words.push_back("time");
  if (reads(set, Reads::history)) words.push_back("earlier frames");
  return words.empty() ? "nothing of the scene" : fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace lumivox
