#include "pipeline/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace lumivox {

const char* name(LeftOut::Level level) {
  switch (level) {
    case LeftOut::Level::plugin:
      return "plugin";
    case LeftOut::Level::pass:
      return "pass";
    case LeftOut::Level::variant:
      return "variant";
    case LeftOut::Level::resource:
      return "resource";
    case LeftOut::Level::time:
      return "time";
    case LeftOut::Level::camera:
      return "camera";
    case LeftOut::Level::scene:
      return "scene";
  }
  return "";
}

namespace {

std::string passText(const BoundPass& pass) {
  return fmt::format("{} ({}.{})", pass.name, pass.technique, pass.pass);
}

void explainPlugins(const ExplainedRun& run, Explanation& explanation) {
  const std::vector<std::string> named = run.pipeline.techniques();
  for (const std::string& technique : run.techniques.available()) {
    if (std::find(named.begin(), named.end(), technique) != named.end()) continue;
    explanation.leftOut.push_back({LeftOut::Level::plugin, technique, "the pipeline does not name it", {}});
  }
}

void explainPasses(const ExplainedRun& run, Explanation& explanation) {
  for (std::size_t i = 0; i < run.graph.passes.size(); ++i) {
    const BoundPass& pass = run.graph.passes[i];
    if (run.plan.passes[i].kept) continue;
    explanation.leftOut.push_back({LeftOut::Level::pass, passText(pass), run.plan.passes[i].why, pass.name});
  }
}

/// Outputs of kept passes that are not computed and therefore take no memory.
void explainResources(const ExplainedRun& run, Explanation& explanation) {
  for (std::size_t i = 0; i < run.graph.passes.size(); ++i) {
    const BoundPass& pass = run.graph.passes[i];
    if (!run.plan.passes[i].kept) continue;
    for (std::size_t port = 0; port < pass.object->outputs().size(); ++port) {
      const OutputPlan& output = run.plan.passes[i].outputs[port];
      if (output.wanted) continue;
      const OutputIndex index{static_cast<int>(i), static_cast<int>(port)};
      explanation.leftOut.push_back(
          {LeftOut::Level::resource, run.graph.outputText(index), output.why, pass.name});
    }
  }
  if (run.sharedBytes > 0) {
    explanation.leftOut.push_back({LeftOut::Level::resource,
                                   "memory of its own for every resource",
                                   "short-lived ones of the same shape share it",
                                   {},
                                   run.sharedBytes});
  }
}

/// "GLOSSY=0, TEXTURES=off": the axes that have one value in all variants that were needed.
std::string fixedAxes(const shader::PackedProgram& program, const std::set<std::vector<int>>& needed) {
  std::string text;
  for (std::size_t axis = 0; axis < program.axes.size(); ++axis) {
    std::set<int> values;
    for (const std::vector<int>& variant : needed) {
      if (axis < variant.size()) values.insert(variant[axis]);
    }
    if (values.size() != 1 || program.axes[axis].values.size() < 2) continue;
    if (!text.empty()) text += ", ";
    text += fmt::format("{}={}", program.axes[axis].name, program.axes[axis].text(*values.begin()));
  }
  return text;
}

void explainVariants(const ExplainedRun& run, Explanation& explanation) {
  for (const auto& [program, usage] : run.usage) {
    explanation.variantsPossible += usage.possible;
    explanation.variantsCompiled += usage.compiled;
    explanation.variantsNeeded += usage.needed.size();
    // Before the first frame no variant was requested.
    if (run.passMs.empty() || usage.needed.size() >= usage.compiled) continue;
    std::string why = "no pass that ran uses this program";
    if (!usage.needed.empty()) {
      why = "no pass that ran asked for them";
      const std::size_t slash = program.find('/');
      if (const auto pack = run.packs.find(program.substr(0, slash)); pack != run.packs.end()) {
        const std::string fixed = fixedAxes(pack->second.program(program.substr(slash + 1)), usage.needed);
        if (!fixed.empty()) why = "this run needs only " + fixed;
      }
    }
    explanation.leftOut.push_back({LeftOut::Level::variant,
                                   fmt::format("{} of {} variants of {}",
                                               usage.compiled - usage.needed.size(), usage.compiled, program),
                                   why,
                                   {}});
  }
}

/// What changes with time in a scene, by name: a few of each kind. Empty if nothing does.
std::string whatMoves(const Seen& seen) {
  constexpr std::size_t kMostNamed = 3;
  std::vector<std::string> parts;
  const auto add = [&](const char* one, const char* many, const auto& all, const auto& moves) {
    std::vector<std::string> names;
    for (const auto& each : all)
      if (moves(each)) names.push_back(fmt::format("'{}'", each.name));
    if (names.empty()) return;
    const std::size_t more = names.size() - std::min(names.size(), kMostNamed);
    names.resize(names.size() - more);
    parts.push_back(fmt::format("{} {}{}", names.size() == 1 ? one : many, fmt::join(names, ", "),
                                more > 0 ? fmt::format(" and {} more", more) : ""));
  };
  add("light", "lights", seen.scene.lights, [](const Light& light) { return light.motion.has_value(); });
  add("camera", "cameras", seen.scene.cameras,
      [](const Camera& camera) { return camera.keys.size() > 1 || camera.motion; });
  add("object", "objects", seen.scene.objects,
      [](const Object& object) { return object.animated() && !object.parts.empty(); });
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// Kept passes that do not run again in later frames of this scene.
void explainTime(const ExplainedRun& run, Explanation& explanation) {
  const std::string moving = whatMoves(run.seen);
  for (const int index : run.plan.order) {
    const PassPlan& plan = run.plan.passes[static_cast<std::size_t>(index)];
    const BoundPass& pass = run.graph.passes[static_cast<std::size_t>(index)];
    if ((static_cast<std::uint32_t>(plan.dependsOn) & static_cast<std::uint32_t>(run.plan.mayChange)) != 0)
      continue;
    LeftOut leftOut{LeftOut::Level::time, passText(pass) + " in later frames",
                    fmt::format("it depends on {}, which this scene does not change{}",
                                readsText(plan.dependsOn), moving.empty() ? "" : "; what moves: " + moving),
                    pass.name};
    if (const auto ms = run.passMs.find(index); ms != run.passMs.end()) leftOut.savedMs = ms->second;
    explanation.leftOut.push_back(std::move(leftOut));
  }
  for (const FrameContext::Reused& part : run.reusedParts) {
    explanation.leftOut.push_back({LeftOut::Level::time,
                                   fmt::format("{}: {} in later frames", part.pass, part.what),
                                   "made once and kept while nothing it depends on changes", part.pass});
  }
}

/// A trait of a scene, the reads by which a pass sees it, and the effect on the image if no pass does.
struct Trait {
  Reads seenBy;
  LeftOut::Level level;
  enum class In { everyImage, radiance } shownIn;
  std::string (*what)(const Seen&);  ///< empty: the scene lacks it
  const char* why;
};

std::string lensText(const Seen& seen) {
  const Camera& camera = seen.camera;
  return camera.aperture > 0.0
             ? fmt::format("the lens of camera '{}', {:.3g} m wide", camera.name, camera.aperture)
             : std::string();
}

std::string trianglesText(const Seen& seen) {
  return seen.traits.triangles ? "the triangles" : "";
}

std::string materialsText(const Seen& seen) {
  return seen.traits.triangles ? "the materials" : "";
}

std::string lightsText(const Seen& seen) {
  const SceneTraits& traits = seen.traits;
  const int lights = traits.areaLights + traits.directionalLights + traits.pointLights + traits.spotLights;
  return lights == 0 ? "" : lights == 1 ? "the light" : fmt::format("the {} lights", lights);
}

std::string environmentText(const Seen& seen) {
  return seen.traits.environment ? "the environment" : "";
}

std::string mediaText(const Seen& seen) {
  std::vector<std::string> names;
  for (const Medium& medium : seen.scene.media) names.push_back(fmt::format("'{}'", medium.name));
  return names.empty() ? ""
                       : fmt::format("{} {}", names.size() == 1 ? "medium" : "media", fmt::join(names, ", "));
}

std::string capturesText(const Seen& seen) {
  std::vector<std::string> names;
  for (const auto& capture : seen.scene.captures) names.push_back(fmt::format("'{}'", capture->name));
  return names.empty() ? ""
                       : fmt::format("the frames of {} {}", names.size() == 1 ? "capture" : "captures",
                                     fmt::join(names, ", "));
}

constexpr Trait kTraits[] = {{Reads::lens, LeftOut::Level::camera, Trait::In::everyImage, lensText,
                              "no pass sees through a lens: the image is that of a pinhole"},
                             {Reads::geometry, LeftOut::Level::scene, Trait::In::everyImage, trianglesText,
                              "no pass reads geometry: the image is that of an empty scene"},
                             {Reads::materials, LeftOut::Level::scene, Trait::In::radiance, materialsText,
                              "no pass reads materials: the image is that of surfaces without any"},
                             {Reads::lights, LeftOut::Level::scene, Trait::In::radiance, lightsText,
                              "no pass reads lights: the image is that of an unlit scene"},
                             {Reads::environment, LeftOut::Level::scene, Trait::In::radiance, environmentText,
                              "no pass reads the environment: the image is that of a black one"},
                             {Reads::media, LeftOut::Level::scene, Trait::In::radiance, mediaText,
                              "no pass reads media: the image is that of clear air"},
                             {Reads::capture, LeftOut::Level::scene, Trait::In::radiance, capturesText,
                              "no pass reads captured frames: nothing of the real scene lights the image"}};

}  // namespace

std::vector<LeftOut> unreadTraits(const Seen& seen, const BoundGraph& graph, const PrunePlan& plan,
                                  const PruneRequest& request) {
  bool anyImage = false, anyRadiance = false;
  for (std::size_t i = 0; i < graph.outputs.size(); ++i) {
    const OutputIndex source = graph.outputs[i].source;
    if (!request.wanted[i] || !plan.output(source).wanted) continue;
    const Contributes held = graph.output(source).contributes();
    anyImage = true;
    anyRadiance = anyRadiance || (held != Contributes::nothing && held != Contributes::ambientOcclusion);
  }
  Reads read = Reads::nothing;
  for (const int index : plan.order)
    read = read | graph.passes[static_cast<std::size_t>(index)].object->readsFrom();
  std::vector<LeftOut> unread;
  for (const Trait& trait : kTraits) {
    if (reads(read, trait.seenBy) || !(trait.shownIn == Trait::In::radiance ? anyRadiance : anyImage))
      continue;
    if (std::string what = trait.what(seen); !what.empty())
      unread.push_back({trait.level, std::move(what), trait.why, {}});
  }
  return unread;
}

Explanation explainRun(const ExplainedRun& run) {
  Explanation explanation;
  explanation.passesTotal = run.graph.passes.size();
  explanation.passesKept = run.plan.order.size();
  explanation.poolBytes = run.poolBytes;
  explanation.sharedBytes = run.sharedBytes;
  explainPlugins(run, explanation);
  explainPasses(run, explanation);
  explainVariants(run, explanation);
  explainResources(run, explanation);
  if (!run.keepEverything) explainTime(run, explanation);
  for (LeftOut& trait : unreadTraits(run.seen, run.graph, run.plan, run.request))
    explanation.leftOut.push_back(std::move(trait));
  return explanation;
}

}  // namespace lumivox
