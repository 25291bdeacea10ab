#include "measure_options.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/dsl/document.h"
#include "lumivox/results/text.h"

namespace lumivox::command {

void MeasureOptions::addTo(CLI::App& app, const std::string& store, const std::string& scenes) {
  app.add_option("SCENE", options.scenes, scenes)->required();
  app.add_option("--pipeline", options.pipelines,
                 "pipelines' texts (default: every committed one that suits the scene)");
  run.addTo(app);
  display.addExposureTo(app);
  app.add_option("--spp", options.referenceSamples,
                 "the reference's samples per pixel (default: by the size of the image)")
      ->check(CLI::Range(1, 1 << 24));
  app.add_option("--subpixels", options.subpixels,
                 "judged images are means over N positions in the pixel (default 16; 1: its centre)")
      ->check(CLI::Range(1, 4096));
  app.add_option("--repeats", options.repeats, "timed frames per point (default 5)")
      ->check(CLI::Range(1, 10000));
  app.add_option("--seeds", options.seeds, "seeds per point (default 3)")->check(CLI::Range(1, 10000));
  app.add_option("--flicker-frames", options.flickerPairs,
                 "pairs of frames 1/24 s apart for the flicker of scenes that move (default 4; 0: none)")
      ->check(CLI::Range(0, 1000));
  app.add_option(
         "--frames", options.frames,
         "pipelines that accumulate are measured after 1, 2, 4 ... N frames of the still scene (default 1)")
      ->check(CLI::Range(1, 1 << 20));
  app.add_flag("--no-sweep", noSweep, "only the default parameters, not the points of the pipelines' sweeps");
  app.add_option("--store", options.store, store);
}

ReportOptions MeasureOptions::asked(const GlobalOptions& global) const {
  ReportOptions asked = options;
  asked.settings = run.settings;
  asked.camera = run.camera;
  asked.time = run.time;
  asked.seed = run.seed;
  std::tie(asked.width, asked.height) = run.size();
  asked.exposure = display.given();
  asked.tone = display.toneCurve();
  asked.openSweeps = !noSweep;
  asked.commandLine = global.commandLine;
  asked.repeatArguments = repeatArguments(global);
  asked.progress = [](std::size_t done, std::size_t total, double secondsLeft) {
    logInformation("{} of {} points{}", done, total,
                   done < total ? ", about " + durationText(secondsLeft) + " left" : std::string());
  };
  return asked;
}

std::string durationText(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
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

double millisecondsOf(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  std::string unit = end;
  unit.erase(0, unit.find_first_not_of(' '));
  if (unit.empty()) unit = "ms";
  if (end != text.c_str() && std::isfinite(number) && number > 0.0)
    for (const dsl::Unit& known : dsl::knownUnits())
      if (known.name == unit && known.dimension == dsl::kTime) return number * known.toBase * 1000.0;
  throw Error(fmt::format("{} '{}': expected a time above 0, such as 16ms or 0.5s", option, text));
}

double positiveNumberOf(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0' || !std::isfinite(number) || !(number > 0.0))
    throw Error(fmt::format("{} '{}': expected a number above 0", option, text));
  return number;
}

std::string quartilesText(const TimingStatistics& time) {
  return time.repeats == 0
             ? "-"
             : fmt::format("{} [{}, {}]", formatMilliseconds(time.median),
                           formatMilliseconds(time.lowerQuartile), formatMilliseconds(time.upperQuartile));
}

std::string parametersText(const std::map<std::string, std::string>& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters) text += (text.empty() ? "" : " ") + name + "=" + value;
  return text;
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

std::string rmseText(const ComponentError* error) {
  if (error == nullptr) return "";
  const Measured rmse = error->error.rmse;
  const double ratio = error->ratioToNothing();
  return fmt::format("{:.3g} ± {:.1g}", rmse.value, rmse.uncertainty) +
         (ratio == ratio ? fmt::format(" ({:.2f})", ratio) : std::string());
}

}  // namespace lumivox::command
