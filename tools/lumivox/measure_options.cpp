#include "measure_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <utility>

#include "common/named_texts.h"
#include "lumivox/analysis/comparison.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/results/text.h"

namespace lumivox::command {

void MeasureOptions::addTo(CLI::App& app, const std::string& store, const std::string& scenes) {
  takesNames(app.add_option("SCENE", options.scenes, scenes)->required(), NamedText::sceneOrPipeline);
  takesNames(
      addRepeatable(
          app, "--pipeline", options.pipelines,
          "a pipeline's text or name; may be repeated (default: every committed one that suits the scene)"),
      NamedText::pipeline);
  run.addTo(app);
  display.addExposureTo(app);
  app.add_option("--spp", options.referenceSamples,
                 "the reference's samples per pixel (default: by the size of the image)")
      ->check(CLI::Range(1, 1 << 24));
  app.add_flag("--quick", quick,
               "for a look: one timed frame, one seed and four positions in the pixel for each point, unless "
               "--repeats, --seeds or --subpixels say otherwise");
  subpixels_ =
      app.add_option("--subpixels", options.subpixels,
                     "judged images are means over N positions in the pixel (default 16; 1: its centre)")
          ->check(CLI::Range(1, 4096));
  repeats_ = app.add_option("--repeats", options.repeats, "timed frames per point (default 5)")
                 ->check(CLI::Range(1, 10000));
  seeds_ =
      app.add_option("--seeds", options.seeds, "seeds per point (default 3)")->check(CLI::Range(1, 10000));
  app.add_option("--flicker-frames", options.flickerPairs,
                 "pairs of frames 1/24 s apart for the flicker of scenes that move (default 4; 0: none)")
      ->check(CLI::Range(0, 1000));
  app.add_option(
         "--accumulate", options.frames,
         "pipelines that accumulate are measured after 1, 2, 4 ... N frames of the still scene (default 1)")
      ->check(CLI::Range(1, 1 << 20));
  app.add_flag("--no-sweep", noSweep, "only the default parameters, not the points of the pipelines' sweeps");
  app.add_option("--store", options.store, store);
}

void MeasureOptions::addBudgetTo(CLI::App& app, const std::string& order) {
  addDuration(app, "--budget", options.budgetSeconds,
              "time for measuring, such as 30s or 5min, counted when the references are there: " + order +
                  "; the same command goes on (default: no limit)");
}

ReportOptions MeasureOptions::asked(const GlobalOptions& global, const std::string& doing,
                                    const std::string& unit) const {
  ReportOptions asked = options;
  const auto isPipeline = [](const std::filesystem::path& file) {
    return kindOfText(file) == TextKind::pipeline;
  };
  const auto pipelines =
      std::stable_partition(asked.scenes.begin(), asked.scenes.end(), std::not_fn(isPipeline));
  asked.pipelines.insert(asked.pipelines.end(), pipelines, asked.scenes.end());
  asked.scenes.erase(pipelines, asked.scenes.end());
  if (asked.scenes.empty()) throw Error("no scene; expected a scene's text");
  asked.settings = run.settings;
  asked.camera = run.camera;
  asked.time = run.time;
  asked.seed = run.seed;
  std::tie(asked.width, asked.height) = run.size();
  asked.exposure = display.given();
  asked.tone = display.toneCurve();
  asked.openSweeps = !noSweep;
  if (quick) {
    asked.isLook = true;
    if (subpixels_->count() == 0) asked.subpixels = 4;
    if (repeats_->count() == 0) asked.repeats = 1;
    if (seeds_->count() == 0) asked.seeds = 1;
  }
  asked.commandLine = global.commandLine;
  asked.repeatArguments = repeatArguments(global);
  asked.progress = progressLine(doing, unit);
  return asked;
}

std::function<void(std::size_t, std::size_t, double)> progressLine(const std::string& what,
                                                                   const std::string& unit) {
  return
      [line = std::make_shared<Progress>(what, 0, unit)](
          std::size_t done, std::size_t total, double secondsLeft) { line->show(done, total, secondsLeft); };
}

std::vector<std::string> repeatArguments(const GlobalOptions& global) {
  std::vector<std::string> arguments;
  if (global.device != "auto") arguments.insert(arguments.end(), {"--device", global.device});
  if (global.shaders != "auto") arguments.insert(arguments.end(), {"--shaders", global.shaders});
  if (global.arithmetic != "exact") arguments.insert(arguments.end(), {"--arithmetic", global.arithmetic});
  if (global.memory != 0) arguments.insert(arguments.end(), {"--memory", std::to_string(global.memory)});
  for (const auto& folder : global.assets) arguments.insert(arguments.end(), {"--assets", folder.string()});
  for (const auto& folder : global.techniques)
    arguments.insert(arguments.end(), {"--techniques", folder.string()});
  if (global.strict) arguments.emplace_back("--strict");
  return arguments;
}

void refuseFrameTimeAsBudget(CLI::App& app) {
  const auto refuse = [](const std::string& value) {
    throw CLI::ValidationError(
        fmt::format("--budget '{}': a budget is time for measuring; expected --frame-time {}", value, value));
  };
  app.add_option_function<std::string>("--budget", refuse)->group("");
}

std::string noTimeText(std::size_t points, double neededSeconds, const std::string& commandLine) {
  const std::string left = fmt::format("no time for {} point{}", points, points == 1 ? "" : "s");
  if (neededSeconds > 0.0)
    return fmt::format("{}: none would have ended in time; --budget {:.0f}s begins the shortest\n", left,
                       5.0 * std::ceil(neededSeconds / 5.0));
  return fmt::format("{}; the same command goes on with them: {}\n", left, commandLine);
}

double positiveNumberOf(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0' || !std::isfinite(number) || !(number > 0.0))
    throw Error(fmt::format("{} '{}': expected a number above 0", option, text));
  return number;
}

std::string quartilesText(const TimingStatistics& time) {
  if (time.repeats == 0) return "-";
  const std::string quartiles = formatQuartiles(time);
  return formatMilliseconds(time.median) + (quartiles.empty() ? "" : " " + quartiles);
}

std::string parametersText(const std::map<std::string, std::string>& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters) text += (text.empty() ? "" : " ") + name + "=" + value;
  return text;
}

std::vector<std::string> lineNames(const std::vector<const ReportPoint*>& points) {
  struct Group {
    std::size_t points = 0;
    std::map<std::string, std::map<std::string, std::size_t>>
        values;  ///< of each parameter, with their counts
  };
  std::map<std::pair<std::string, std::string>, Group> groups;
  for (const ReportPoint* point : points) {
    Group& group = groups[{point->scene, point->pipeline}];
    ++group.points;
    for (const auto& [name, value] : point->parameters) ++group.values[name][value.text()];
  }
  std::vector<std::string> names;
  for (const ReportPoint* point : points) {
    const Group& group = groups.at({point->scene, point->pipeline});
    std::map<std::string, std::string> differing;
    for (const auto& [name, value] : point->parameters) {
      const std::string text = value.text();
      if (group.values.at(name).at(text) != group.points) differing[name] = text;
    }
    names.push_back(shortName(point->pipeline) + (differing.empty() ? "" : " " + parametersText(differing)));
  }
  return names;
}

const ComponentError* errorOf(const ReportPoint& point, const std::string& output, bool bias) {
  const ComponentError* only = nullptr;
  for (const ComponentError& error : point.errors) {
    if (error.output != output) continue;
    if (error.bias == bias) return &error;
    if (only == nullptr) only = &error;
  }
  return only;
}

std::string errorText(const ComponentError* error) {
  if (error == nullptr) return "";
  const Measured number = errorNumber(*error, kDefaultMetric);
  return fmt::format("{:.3g} ± {:.1g}", number.value, number.uncertainty);
}

std::string errorHeading(const std::string& output) {
  return output == kWholeImage ? "FLIP, all light" : "FLIP, " + output;
}

std::vector<std::string> judgedOutputs(const std::vector<const ReportPoint*>& points) {
  std::vector<std::string> outputs;
  for (const std::string& component : comparableComponents())
    for (const ReportPoint* point : points)
      for (const ComponentError& error : point->errors)
        if (error.component == component &&
            std::find(outputs.begin(), outputs.end(), error.output) == outputs.end())
          outputs.push_back(error.output);
  return outputs;
}

const char* const kErrorNote =
    "FLIP: 0 where a viewer sees no difference to the reference, 1 at most; ± one standard uncertainty. All "
    "light: against full transport; outputs: against the technique's own model.\n";

}  // namespace lumivox::command
