// report: the main job.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/outputs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/page/page.h"
#include "lumivox/results/text.h"
#include "measure_options.h"

namespace lumivox::command {
namespace {

/// Points for which there was no time, "scene, pipeline: cones=6" each, in a line for each pipeline.
std::string leftOutText(const std::vector<std::string>& leftOut) {
  std::vector<std::pair<std::string, std::string>> lines;
  for (const std::string& one : leftOut) {
    const std::size_t end = std::min(one.find(": "), one.size());
    const std::string pipeline = one.substr(0, end);
    const auto line = std::find_if(lines.begin(), lines.end(),
                                   [&](const auto& candidate) { return candidate.first == pipeline; });
    if (line == lines.end())
      lines.emplace_back(pipeline, one);
    else
      line->second += ";" + one.substr(std::min(end + 1, one.size()));
  }
  std::string text;
  for (const auto& [pipeline, line] : lines) text += "no time for: " + line + "\n";
  return text.empty() ? text : text + "a longer --budget measures them too\n";
}

/// "12.5 % (1.0 of 8.0 ms)", or "nothing" where leaving out does not make a frame shorter.
std::string savingText(double share, const TimingStatistics& pruned, const TimingStatistics& unpruned) {
  if (!(share > 0.0)) return "nothing";
  return fmt::format("{} ({} of {} ms)", formatPercent(share),
                     formatMilliseconds(unpruned.median - pruned.median),
                     formatMilliseconds(unpruned.median));
}

struct ReportCommand {
  MeasureOptions measure;
  std::vector<std::string> equalTimes, equalErrors;
  bool json = false, csv = false, brief = false;
};

void printSummary(const ReportSummary& summary) {
  std::vector<const ReportPoint*> points;
  for (const ReportPoint& point : summary.points) points.push_back(&point);
  const std::vector<std::string> outputs = judgedOutputs(points);

  std::vector<std::vector<std::string>> rows{{"Scene", "Pipeline", "Parameters", "Frame ms"}};
  for (const std::string& output : outputs) rows[0].push_back(errorHeading(output));
  rows[0].push_back("Memory");
  rows[0].push_back("Health");
  for (const ReportPoint& point : summary.points) {
    std::map<std::string, std::string> parameters;
    for (const auto& [name, value] : point.parameters) parameters[name] = value.text();
    std::vector<std::string> row{std::filesystem::path(point.scene).stem().string(),
                                 std::filesystem::path(point.pipeline).stem().string(),
                                 parametersText(parameters), quartilesText(point.frameMs)};
    for (const std::string& output : outputs)
      row.push_back(errorText(errorOf(point, output, output != kWholeImage)));
    row.push_back(formatBytes(point.peakBytes));
    row.push_back(!point.failure.empty()         ? painted(Paint::bad, "failed")
                  : point.healthFindings.empty() ? painted(Paint::good, "good")
                                                 : fmt::format("{} findings", point.healthFindings.size()));
    rows.push_back(std::move(row));
  }
  std::string table = groupedTable(rows, 2), text = kErrorNote;
  for (const PruningRecord& pruning : summary.pruning)
    text += fmt::format(
        "{}, {}: leaving out what the scene does not need saves {} of a first frame and {} of the next ones with a "
        "moving camera; same image: {}\n",
        std::filesystem::path(pruning.scene).stem().string(),
        std::filesystem::path(pruning.pipeline).stem().string(),
        savingText(pruning.savedShare(), pruning.prunedMs, pruning.unprunedMs),
        savingText(pruning.savedShareNext(), pruning.nextPrunedMs, pruning.nextUnprunedMs),
        pruning.sameImage ? "yes" : "NO");
  for (const auto& [scene, display] : summary.displays)
    text += fmt::format("{}: images, SSIM and LDR-FLIP at {}, tone {}\n",
                        std::filesystem::path(scene).stem().string(), exposureText(display.exposure),
                        name(display.tone));
  if (summary.takenUp > 0)
    text += fmt::format("{} of {} points were taken up from an interrupted report\n", summary.takenUp,
                        summary.points.size());
  text += leftOutText(summary.leftOutPoints);
  for (const std::string& unsuited : summary.unsuited) text += "not run: " + unsuited + "\n";
  print(table + remarks(text));
}

int report(const ReportCommand& command, const GlobalOptions& global) {
  ReportOptions options = command.measure.asked(global);
  for (const std::string& text : command.equalTimes)
    options.equalTimesMs.push_back(1000.0 * secondsOf("--equal-time", text));
  for (const std::string& text : command.equalErrors)
    options.equalErrors.push_back(positiveNumberOf("--equal-error", text));
  const ReportFiles files = reportFiles(options.output);
  std::vector<std::filesystem::path> inputs = options.scenes;
  inputs.insert(inputs.end(), options.pipelines.begin(), options.pipelines.end());
  inputs.push_back(options.store);
  const Outputs outputs = Outputs()
                              .add("-o", files.page, {".html", ".htm"}, Outputs::Endings::otherKindsRefused)
                              .add("-o", files.csv, {".csv"})
                              .add("-o", files.json, {".json"})
                              .add("-o", unfinishedStoreOf(files.page), {".sqlite"});
  outputs.check(inputs);
  options.allRead = [&] { outputs.requireUnread(); };
  options.output = files.page;
  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  const ReportSummary summary = makeReport(
      *device, techniques, options, [&](const std::filesystem::path& file) { return global.loadScene(file); },
      [&](const ReportRecord& record) {
        writeReport(files, record, command.brief ? ReportDetail::brief : ReportDetail::whole);
      });
  if (command.json) {
    print(readFile(files.json));
  } else if (command.csv) {
    print(readFile(files.csv));
  } else {
    printSummary(summary);
    print(files.page.string() + "\n");
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
  command->add_option("-o,--out", all->measure.options.output,
                      "the page; .csv and .json go beside it (default out/report/index.html)");
  all->measure.addTo(*command, "a results store that the measured points are added to (default: none)");
  addDuration(
      *command, "--budget", all->measure.options.budgetSeconds,
      "time for measuring, such as 30s or 5min, counted when the references are there: all default points, "
      "then as many points of the sweeps as there is time for (default: no limit)");
  all->measure.display.addToneTo(*command);
  command
      ->add_option("--voxels", all->measure.options.voxelResolution,
                   "adds a section on the voxelizers at this resolution (default: none)")
      ->check(CLI::Range(1, 1024));
  addRepeatable(
      *command, "--equal-time", all->equalTimes,
      "a budget of the table of equal time, such as 16ms; may be repeated (default: round numbers)");
  addRepeatable(*command, "--equal-error", all->equalErrors,
                "an error of the table of equal error; may be repeated (default: round numbers)");
  command->add_flag(
      "--brief", all->brief,
      "a page of one screen per scene, with the images of the default points alone; CSV and JSON "
      "hold everything");
  auto* json = command->add_flag("--json", all->json, "print the JSON in place of the table");
  command->add_flag("--csv", all->csv, "print the CSV in place of the table")->excludes(json);
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return report(*all, global); });
}

}  // namespace lumivox::command
