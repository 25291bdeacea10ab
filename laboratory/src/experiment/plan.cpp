#include "experiment/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <unordered_map>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/installation.h"
#include "lumivox/pipeline/pass.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

/// The folder `scenes` that contains `pipelines`, in `start` or a folder above it.
std::optional<fs::path> scenesAbove(fs::path start) {
  std::error_code ignored;
  start = fs::weakly_canonical(start, ignored);
  for (fs::path folder = start; !folder.empty(); folder = folder.parent_path()) {
    if (folder.filename() == "scenes" && fs::is_directory(folder / "pipelines", ignored)) return folder;
    if (fs::is_directory(folder / "scenes" / "pipelines", ignored)) return folder / "scenes";
    if (folder == folder.root_path()) break;
  }
  return std::nullopt;
}

/// Finds why an output of a pass stays at its neutral element on a scene with these traits: a need of its
/// own, of its pass, or of a pass that a required input comes from.
class NeedsWalk {
 public:
  NeedsWalk(const Pipeline& pipeline, TechniqueSource& techniques, const SceneTraits& traits)
      : pipeline_(pipeline), techniques_(techniques), traits_(traits) {}

  std::string unmet(const std::string& passName, const std::string& port) {
    if (!visited_.insert(passName + "." + port).second) return {};  // a cycle, which binding reports
    const auto text = std::find_if(pipeline_.passes.begin(), pipeline_.passes.end(),
                                   [&](const PassText& pass) { return pass.name == passName; });
    if (text == pipeline_.passes.end()) return {};
    const std::unique_ptr<Pass> pass = make(*text);
    if (!pass) return {};
    if (std::string need = unmetNeed(pass->needs(), traits_); !need.empty()) return need;
    for (const OutBase* output : pass->outputs())
      if (output->name() == port || (port.empty() && pass->outputs().size() == 1))
        if (std::string need = unmetNeed(output->needs(), traits_); !need.empty()) return need;
    for (const InBase* input : pass->inputs())
      if (input->presence() == Presence::required)
        if (std::string need = unmetSource(*text, input->name()); !need.empty()) return need;
    return {};
  }

  Contributes component(const Pipeline::Output& output) {
    const auto text = std::find_if(pipeline_.passes.begin(), pipeline_.passes.end(),
                                   [&](const PassText& pass) { return pass.name == output.pass; });
    if (text == pipeline_.passes.end()) return Contributes::nothing;
    const std::unique_ptr<Pass> pass = make(*text);
    if (pass)
      for (const OutBase* port : pass->outputs())
        if (port->name() == output.port) return port->contributes();
    return Contributes::nothing;
  }

 private:
  std::unique_ptr<Pass> make(const PassText& text) {
    const Technique* technique = techniques_.technique(text.technique);
    const PassEntry* entry = technique == nullptr ? nullptr : technique->find(text.pass);
    return entry == nullptr ? nullptr : entry->make();
  }

  std::string unmetSource(const PassText& text, const std::string& input) {
    if (text.block == nullptr) return {};
    for (const dsl::Item& item : text.block->items) {
      if (!item.property || item.property->word != input || item.property->values.empty()) continue;
      const std::string& source = item.property->values.front().text;
      const std::size_t dot = source.find('.');
      return unmet(source.substr(0, dot), dot == std::string::npos ? std::string() : source.substr(dot + 1));
    }
    return {};
  }

  const Pipeline& pipeline_;
  TechniqueSource& techniques_;
  const SceneTraits& traits_;
  std::set<std::string> visited_;
};

}  // namespace

std::optional<fs::path> committedScenes(const fs::path& start) {
  if (!start.empty())
    if (auto found = scenesAbove(start)) return found;
  std::error_code ignored;
  if (auto found = scenesAbove(fs::current_path(ignored))) return found;
  if (const auto pipelines = programData("scenes/pipelines")) return pipelines->parent_path();
  return std::nullopt;
}

std::vector<fs::path> pipelinesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure))
    if (entry.path().extension() == ".pipeline" && entry.is_regular_file(failure))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string whyUnsuited(const Pipeline& pipeline, TechniqueSource& techniques, const SceneTraits& traits) {
  std::string firstNeed;
  bool adds = false;  // anything besides direct light
  for (const bool withDirect : {false, true}) {
    for (const Pipeline::Output& output : pipeline.outputs) {
      NeedsWalk walk(pipeline, techniques, traits);
      if (!withDirect && walk.component(output) == Contributes::direct) continue;
      adds = true;
      const std::string need = walk.unmet(output.pass, output.port);
      if (need.empty()) return {};
      if (firstNeed.empty()) firstNeed = fmt::format("output '{}' needs {}", output.name, need);
    }
    if (adds) break;  // a pipeline of direct light alone is judged by its direct light
  }
  return firstNeed;
}

std::pair<int, int> reducedResolution(int width, int height, int limit) {
  const int longest = std::max(width, height);
  if (longest <= limit || longest <= 0) return {width, height};
  const double scale = static_cast<double>(limit) / longest;
  const auto reduced = [&](int size) { return std::max(1, static_cast<int>(std::lround(size * scale))); };
  return {reduced(width), reduced(height)};
}

int referenceSamplesFor(int width, int height) {
  // Paths in the whole image; with so many the committed scenes take about a minute on two cores at 128 x
  // 128.
  constexpr double kPaths = 8.0e6;
  constexpr int kFewest = 64, kMost = 4096;
  const double pixels = std::max(1.0, static_cast<double>(width) * height);
  return std::clamp(static_cast<int>(std::lround(kPaths / pixels)), kFewest, kMost);
}

}  // namespace lumivox

namespace lumivox::experiment {

namespace {

/// Compares the values, not their texts: 64 in the text equals 64 in a sweep.
bool sameParameters(const ParameterValues& a, const ParameterValues& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& other) {
    return one.first == other.first && one.second.text() == other.second.text();
  });
}

ParameterValues defaultsOf(const Pipeline& pipeline, const ParameterValues& settings) {
  ParameterValues defaults;
  for (const PipelineParameter& parameter : pipeline.parameters) defaults[parameter.name] = parameter.value;
  for (const auto& [name, value] : settings) defaults[name] = value;
  return defaults;
}

/// Points by their parameters, so that plans may be long.
class PointList {
 public:
  explicit PointList(std::vector<PlannedPoint> points = {}) {
    for (PlannedPoint& point : points) add(std::move(point));
  }
  void add(PlannedPoint point) {
    std::string text;
    for (const auto& [name, value] : point.parameters) text += name + "=" + value.text() + "\n";
    const auto [known, isNew] = indices_.emplace(std::move(text), points_.size());
    if (isNew) {
      points_.push_back(std::move(point));
      return;
    }
    std::vector<std::uint64_t>& seeds = points_[known->second].seeds;
    for (const std::uint64_t seed : point.seeds)
      if (std::find(seeds.begin(), seeds.end(), seed) == seeds.end()) seeds.push_back(seed);
  }
  std::vector<PlannedPoint> take() { return std::move(points_); }

 private:
  std::vector<PlannedPoint> points_;
  std::unordered_map<std::string, std::size_t> indices_;
};

}  // namespace

std::vector<PlannedPoint> pointsOfSweeps(const Pipeline& pipeline, const ParameterValues& settings,
                                         const std::vector<Sweep>& sweeps, bool progressive) {
  const ParameterValues defaults = defaultsOf(pipeline, settings);
  PointList points;
  for (const Sweep& sweep : sweeps)
    for (const ParameterValues& swept : sweep.points()) {
      ParameterValues values = defaults;
      for (const auto& [name, value] : swept)
        if (settings.find(name) == settings.end()) values[name] = value;
      if (!progressive || framesOf(values) == 1) values.erase(kAccumulatedFrames);
      points.add({sweep.name, values, sameParameters(values, defaults), sweep.seeds});
    }
  return points.take();
}

std::string withoutFrames(const Pipeline& pipeline, const std::vector<Sweep>& sweeps, bool progressive) {
  const auto isFrames = [](const auto& axis) { return axis.first == kAccumulatedFrames; };
  const bool swept = std::any_of(sweeps.begin(), sweeps.end(), [&](const Sweep& sweep) {
    return std::any_of(sweep.axes.begin(), sweep.axes.end(), isFrames);
  });
  if (progressive || !swept) return {};
  return fmt::format("pipeline \"{}\" does not accumulate and is measured without the axis '{}'",
                     pipeline.name, kAccumulatedFrames);
}

std::vector<PlannedPoint> plannedPoints(const Pipeline& pipeline, const ParameterValues& settings,
                                        bool openSweeps, bool progressive, int frames) {
  PointList points(
      pointsOfSweeps(pipeline, settings, openSweeps ? pipeline.sweeps : std::vector<Sweep>(), progressive));
  points.add({"", defaultsOf(pipeline, settings), true, {}});
  PlannedPoint accumulating{kAccumulatedFrames, defaultsOf(pipeline, settings), false, {}};
  for (int now = 1; progressive && now < frames;) {
    now = std::min(2 * now, frames);
    accumulating.parameters[kAccumulatedFrames].number = now;
    points.add(accumulating);
  }
  return points.take();
}

std::vector<std::string> settingsFor(const Pipeline& pipeline, const std::vector<std::string>& assignments) {
  std::vector<std::string> own;
  for (const std::string& assignment : assignments) {
    const std::string name = assignment.substr(0, assignment.find('='));
    if (std::any_of(pipeline.parameters.begin(), pipeline.parameters.end(),
                    [&](const PipelineParameter& parameter) { return parameter.name == name; }))
      own.push_back(assignment);
  }
  return own;
}

std::string shownPath(const std::filesystem::path& path) {
  std::error_code failure;
  const std::filesystem::path absolute = std::filesystem::weakly_canonical(path, failure);
  const std::filesystem::path here = std::filesystem::current_path(failure);
  const std::filesystem::path relative = absolute.lexically_relative(here);
  if (failure || relative.empty() || *relative.begin() == "..") return path.string();
  return relative.string();
}

std::string shellQuoted(const std::string& argument) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || std::strchr("_-./=:,+@%", c) != nullptr;
  };
  if (!argument.empty() && std::all_of(argument.begin(), argument.end(), plain)) return argument;
  std::string quoted = "'";
  for (const char c : argument) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string repeatingCommand(const ReportOptions& options, const std::string& scene,
                             const std::string& pipeline, const ParameterValues& parameters, int width,
                             int height, int samples) {
  std::string command =
      fmt::format("lumivox report {} --pipeline {}", shellQuoted(scene), shellQuoted(pipeline));
  for (const auto& [name, value] : parameters)
    if (name != kAccumulatedFrames) command += " --set " + shellQuoted(name + "=" + value.text());
  if (framesOf(parameters) > 1) command += fmt::format(" --accumulate {}", framesOf(parameters));
  command +=
      fmt::format(" --no-sweep --resolution {}x{} --spp {} --subpixels {} --repeats {} --seeds {} --seed {}",
                  width, height, samples, options.subpixels, options.repeats, options.seeds, options.seed);
  if (options.flickerPairs != ReportOptions{}.flickerPairs)
    command += fmt::format(" --flicker-frames {}", options.flickerPairs);
  if (!options.camera.empty()) command += " --camera " + shellQuoted(options.camera);
  if (options.time != 0.0) command += fmt::format(" --time {}s", options.time);
  if (options.exposure) command += fmt::format(" --exposure {}", *options.exposure);
  if (options.tone != kShownTone) command += fmt::format(" --tone {}", name(options.tone));
  for (const std::string& argument : options.repeatArguments) command += " " + shellQuoted(argument);
  return command;
}

}  // namespace lumivox::experiment
