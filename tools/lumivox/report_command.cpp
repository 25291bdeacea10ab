// report: the main job.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "command.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/report/report.h"

namespace lumivox::command {
namespace {

struct ReportCommand {
  ReportOptions options;
  RunOptions run;
  bool noSweep = false, json = false;
};

std::string quartiles(const TimingStatistics& time) {
  return time.repeats == 0
             ? "-"
             : fmt::format("{} [{}, {}]", formatMilliseconds(time.median),
                           formatMilliseconds(time.lowerQuartile), formatMilliseconds(time.upperQuartile));
}

const ComponentError* find(const ReportPoint& point, const std::string& output, bool bias) {
  const ComponentError* only = nullptr;
  for (const ComponentError& error : point.errors) {
    if (error.output != output) continue;
    if (error.bias == bias) return &error;
    if (only == nullptr) only = &error;
  }
  return only;
}

/// "0.0123 ± 0.0004 (0.31)": RMSE, and in brackets its ratio to leaving the component out.
std::string rmseText(const ComponentError* error) {
  if (error == nullptr) return "";
  const Measured rmse = error->rmse();
  const double ratio = error->ratioToNothing();
  return fmt::format("{:.3g} ± {:.1g}", rmse.value, rmse.uncertainty) +
         (ratio == ratio ? fmt::format(" ({:.2f})", ratio) : std::string());
}

void printSummary(const ReportSummary& summary) {
  // One column of errors per output that any pipeline has; the whole picture first.
  std::vector<std::string> outputs{kWholePicture};
  for (const ReportPoint& point : summary.points)
    for (const ComponentError& error : point.errors)
      if (std::find(outputs.begin(), outputs.end(), error.output) == outputs.end())
        outputs.push_back(error.output);

  std::vector<std::vector<std::string>> rows{{"Scene", "Pipeline", "Parameters", "Frame ms"}};
  for (const std::string& output : outputs)
    rows[0].push_back(output == kWholePicture ? "misses in all" : output + " bias");
  rows[0].push_back("Memory");
  rows[0].push_back("Health");
  for (const ReportPoint& point : summary.points) {
    std::string parameters;
    for (const auto& [name, value] : point.parameters)
      parameters += (parameters.empty() ? "" : " ") + name + "=" + value.text();
    std::vector<std::string> row{std::filesystem::path(point.scene).stem().string(),
                                 std::filesystem::path(point.pipeline).stem().string(), parameters,
                                 quartiles(point.frameMs)};
    for (const std::string& output : outputs)
      row.push_back(rmseText(find(point, output, output != kWholePicture)));
    row.push_back(formatBytes(point.peakBytes));
    row.push_back(!point.failure.empty()         ? "failed"
                  : point.healthFindings.empty() ? "good"
                                                 : fmt::format("{} findings", point.healthFindings.size()));
    rows.push_back(std::move(row));
  }
  std::string text = textTable(rows);
  text +=
      "RMSE in W/(sr m²) ± its uncertainty; in brackets divided by the RMSE of leaving that light out. Bias: "
      "against the technique's "
      "own model; misses: against full transport.\n";
  for (const PruningRecord& pruning : summary.pruning)
    text += fmt::format(
        "{}, {}: leaving out what the scene does not need saves {} of a first frame ({} of {} ms) and "
        "{} of "
        "the next ones with a moving camera ({} of {} ms); same picture: {}\n",
        std::filesystem::path(pruning.scene).stem().string(),
        std::filesystem::path(pruning.pipeline).stem().string(), formatPercent(pruning.savedShare()),
        formatMilliseconds(pruning.unprunedMs.median - pruning.prunedMs.median),
        formatMilliseconds(pruning.unprunedMs.median), formatPercent(pruning.savedShareNext()),
        formatMilliseconds(pruning.nextUnprunedMs.median - pruning.nextPrunedMs.median),
        formatMilliseconds(pruning.nextUnprunedMs.median), pruning.samePicture ? "yes" : "NO");
  for (const std::string& unsuited : summary.unsuited) text += "not run: " + unsuited + "\n";
  print(text);
}

int report(ReportCommand command, const GlobalOptions& global) {
  ReportOptions& options = command.options;
  options.settings = command.run.settings;
  options.camera = command.run.camera;
  options.time = command.run.time;
  options.seed = command.run.seed;
  std::tie(options.width, options.height) = command.run.size();
  options.openSweeps = !command.noSweep;
  options.commandLine = global.commandLine;
  if (global.device != "auto")
    options.repeatArguments.insert(options.repeatArguments.end(), {"--device", global.device});
  if (global.shaders != "auto")
    options.repeatArguments.insert(options.repeatArguments.end(), {"--shaders", global.shaders});
  for (const auto& folder : global.assets)
    options.repeatArguments.insert(options.repeatArguments.end(), {"--assets", folder.string()});

  requireWritable(options.output);
  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  const ReportSummary summary =
      makeReport(*device, techniques, options,
                 [&](const std::filesystem::path& file) { return global.loadScene(file); });
  if (command.json) {
    print(readFile(summary.json));
  } else {
    printSummary(summary);
    print(summary.page.string() + "\n");
  }
  const bool good = std::all_of(summary.points.begin(), summary.points.end(), [](const ReportPoint& point) {
    return point.failure.empty() && point.healthFindings.empty();
  });
  return good ? kGood : kNotGood;
}

}  // namespace

void addReportCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "report", "measures pipelines on scenes: error, time and what was left out, as one page");
  auto all = std::make_shared<ReportCommand>();
  ReportOptions& options = all->options;
  command->add_option("SCENE", options.scenes, "the scenes' texts")->required();
  command->add_option("--pipeline", options.pipelines,
                      "pipelines' texts (default: every committed one that suits the scene)");
  command->add_option("-o,--out", options.output,
                      "the page; .csv and .json go beside it (default out/report/index.html)");
  all->run.addTo(*command);
  command
      ->add_option("--spp", options.truthSamples,
                   "the truth's samples per pixel (default: by the size of the picture)")
      ->check(CLI::Range(1, 1 << 24));
  command
      ->add_option("--subpixels", options.subpixels,
                   "judged pictures are means over N positions in the pixel (default 16; 1: its centre)")
      ->check(CLI::Range(1, 4096));
  command->add_option("--repeats", options.repeats, "timed frames per point (default 5)")
      ->check(CLI::Range(1, 10000));
  command->add_option("--seeds", options.seeds, "seeds per point (default 2)")->check(CLI::Range(1, 10000));
  command->add_flag("--no-sweep", all->noSweep,
                    "only the default parameters, not the points of the pipelines' sweeps");
  command->add_flag("--json", all->json, "print the JSON in place of the table");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return report(*all, global); });
}

}  // namespace lumivox::command
