// report: measures pipelines on scenes and writes the page that compares them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/outputs.h"
#include "lumivox/analysis/comparison.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/sweep.h"
#include "lumivox/page/page.h"
#include "lumivox/results/text.h"
#include "measure_options.h"
#include "share_options.h"

namespace lumivox::command {
namespace {

struct ReportCommand {
  MeasureOptions measure;
  ShareOptions share;
  std::vector<std::string> equalTimes, equalErrors;
  bool json = false, csv = false, brief = false;
};

/// "12.5 % (1.0 of 8.0 ms)"; empty if pruning does not make a frame shorter.
std::string savingText(double share, const TimingStatistics& pruned, const TimingStatistics& unpruned) {
  if (!decidable(medianOf(unpruned), medianOf(pruned)) ||
      !differ(medianOf(unpruned), medianOf(pruned), kSignificantTimeShare) || !(share > 0.0))
    return {};
  return fmt::format("{} ({} of {} ms)", formatPercent(share),
                     formatMilliseconds(unpruned.median - pruned.median),
                     formatMilliseconds(unpruned.median));
}

/// A sentence on what pruning left out and saved in the pipelines of a scene.
std::string neededText(const std::vector<const PruningRecord*>& prunings) {
  if (prunings.empty()) return "what it needs was not measured";
  std::size_t kept = 0, all = 0;
  std::uint64_t bytes = 0;
  const PruningRecord* first = nullptr;
  const PruningRecord* next = nullptr;
  std::string changed;
  for (const PruningRecord* one : prunings) {
    kept += one->prunedPassBytes.size();
    all += one->unprunedPassBytes.size();
    bytes += one->unprunedBytes - std::min(one->prunedBytes, one->unprunedBytes);
    if (one->prunedMs.repeats > 0 && (first == nullptr || one->savedShare() > first->savedShare()))
      first = one;
    if (one->prunedMs.repeats > 0 && (next == nullptr || one->standingShare() > next->standingShare()))
      next = one;
    if (!one->sameImage) changed += " " + std::filesystem::path(one->pipeline).stem().string();
  }
  const auto saved = [](const PruningRecord& one, const std::string& text, const char* of) {
    return text.empty() ? std::string()
                        : fmt::format(", up to {} of {} ({})", text, of,
                                      std::filesystem::path(one.pipeline).stem().string());
  };
  const std::string those = fmt::format("{} pipeline{}", prunings.size(), prunings.size() == 1 ? "" : "s");
  const bool isWhole = kept == all;
  std::string time;
  if (first != nullptr)
    time =
        saved(*first, savingText(first->savedShare(), first->prunedMs, first->unprunedMs), "a first frame");
  // Even if all passes are kept, pruning within them, of outputs and shader variants, may save time and
  // memory.
  std::string text = isWhole ? fmt::format("all {} passes of {} are needed", all, those)
                             : fmt::format("{} of {} passes of {} are needed", kept, all, those);
  const bool savesNothing = isWhole && bytes == 0 && time.empty() && changed.empty();
  if (!savesNothing)
    text += fmt::format("; {} saves {}{}", isWhole ? "what is left out within them" : "leaving out the rest",
                        formatBytes(bytes), time);
  std::string still;
  if (next != nullptr)
    still = saved(*next, savingText(next->standingShare(), next->nextPrunedMs, next->prunedMs),
                  "a first frame's time");
  if (!savesNothing)
    text += changed.empty() ? " and changes no image by a bit" : " and CHANGES the image of" + changed;
  return text + (still.empty() ? "" : "; what stands still while the camera moves saves" + still.substr(1));
}

/// The points of a scene with the least error, the shortest frame, and the ones that no other beats.
std::string verdict(const std::vector<const ReportPoint*>& points, const std::vector<std::string>& names) {
  const PipelineComparison comparison = comparePipelines(points, "final", false, kDefaultMetric, {});
  if (comparison.points.empty()) return "no pipeline was judged\n";
  const auto text = [&](const ComparedPoint& point) {
    return fmt::format("{} ({} ms, FLIP {:.3g})", names[point.source],
                       formatMilliseconds(point.frameMs.median), point.tradeOff.error.value);
  };
  const auto least = std::min_element(comparison.points.begin(), comparison.points.end(),
                                      [](const ComparedPoint& a, const ComparedPoint& b) {
                                        return a.tradeOff.error.value < b.tradeOff.error.value;
                                      });
  std::vector<std::string> front;
  for (std::size_t i = 0; i < comparison.pipelines.size(); ++i)
    if (comparison.hasFront(i))
      front.push_back(std::filesystem::path(comparison.pipelines[i].pipeline).stem().string());
  return fmt::format("least error: {}\nfastest: {}\nbeaten by none at their cost: {}\n", text(*least),
                     text(comparison.points.front()), fmt::join(front, ", "));
}

void printSummary(const ReportSummary& summary, const ReportOptions& options) {
  std::vector<const ReportPoint*> points;
  for (const ReportPoint& point : summary.points) points.push_back(&point);
  const std::vector<std::string> names = lineNames(points);
  std::vector<std::string> outputs;
  if (outputColumns() >= kWideColumns)
    for (const std::string& output : judgedOutputs(points))
      if (output != kWholeImage) outputs.push_back(output);

  std::vector<std::vector<std::string>> rows{{"Scene", "Pipeline", "Frame ms", "FLIP", "Of black"}};
  for (const std::string& output : outputs) rows[0].push_back(errorHeading(output));
  if (!outputs.empty()) rows[0].push_back("Memory");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ReportPoint& point = *points[i];
    std::vector<std::string> row{std::filesystem::path(point.scene).stem().string(), names[i],
                                 point.frameMs.repeats == 0 ? "-" : formatMilliseconds(point.frameMs.median)};
    const ComponentError* whole = errorOf(point, kWholeImage, false);
    if (!point.failure.empty())
      row.push_back(painted(Paint::bad, "failed"));
    else
      row.push_back(errorText(whole));
    row.push_back(whole == nullptr ? "" : fmt::format("{:.2g}", whole->ratioToNothing()));
    for (const std::string& output : outputs) row.push_back(errorText(errorOf(point, output, true)));
    if (!outputs.empty()) row.push_back(formatBytes(point.peakBytes));
    rows.push_back(std::move(row));
  }
  std::string table = groupedTable(rows, 1), text;
  text += fmt::format(
      "FLIP: of the whole image against full transport, ± one standard uncertainty. {} Of black: RMSE over "
      "that of no light at all.\n",
      kDefaultMetricSays);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i]->failure.empty()) text += fmt::format("{} failed: {}\n", names[i], points[i]->failure);
    if (!points[i]->healthFindings.empty())
      text += fmt::format("{}: {} findings of NaN, infinite or negative values, the first: {}\n", names[i],
                          points[i]->healthFindings.size(), points[i]->healthFindings.front());
  }
  for (const auto& [scene, display] : summary.displays) {
    std::vector<const PruningRecord*> prunings;
    for (const PruningRecord& one : summary.pruning)
      if (one.scene == scene) prunings.push_back(&one);
    const std::string place = std::filesystem::path(scene).stem().string();
    text += fmt::format("{}: images, SSIM and LDR-FLIP at {}, tone {}\n{}: {}\n", place,
                        exposureText(display.exposure), name(display.tone), place, neededText(prunings));
  }
  if (summary.takenUp > 0)
    text += fmt::format("{} of {} points were taken up from an earlier run\n", summary.takenUp,
                        summary.points.size());
  if (!summary.unsuited.empty())
    text += fmt::format("{} pipeline{} do not suit: {}\n", summary.unsuited.size(),
                        summary.unsuited.size() == 1 ? "" : "s", fmt::join(summary.unsuited, "; "));
  if (summary.leftOutPoints > 0)
    text += noTimeText(summary.leftOutPoints, summary.neededSeconds, options.commandLine);
  else if (summary.leftOutPrunings > 0)
    text += fmt::format("no time to time what leaving out saves, of {} pipelines\n", summary.leftOutPrunings);
  std::set<std::string> scenes;
  for (const ReportPoint* point : points) scenes.insert(point->scene);
  for (const std::string& scene : scenes) {
    std::vector<const ReportPoint*> own;
    std::vector<std::string> ownNames;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (points[i]->scene == scene) own.push_back(points[i]), ownNames.push_back(names[i]);
    if (scenes.size() > 1) text += std::filesystem::path(scene).stem().string() + ":\n";
    text += verdict(own, ownNames);
  }
  print(table + remarks(text));
}

/// The points of a report as those of a sweep, with their images, for the store that the page takes them
/// from.
SweepOptions sharedPoints(const ReportCommand& command, const ReportOptions& options,
                          const std::filesystem::path& page) {
  SweepOptions points;
  points.measure = options;
  points.forReport = true;
  points.shard = command.share.shard();
  points.points = command.share.points;
  points.into = command.share.into;
  if (command.share.plans() && points.into.empty()) points.into = unfinishedStoreOf(page);
  return points;
}

/// Measures a share of the points and writes no page.
int measureShare(const ReportCommand& command, const GlobalOptions& global, const SweepOptions& points) {
  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  ResultsStore store(command.measure.options.store);
  const SweepSummary summary =
      runSweep(*device, techniques, points, store,
               [&](const std::filesystem::path& file) { return global.loadScene(file); });
  print(fmt::format("{} measured, {} already there; {}\n", summary.measured, summary.held,
                    store.file().string()));
  return summary.failed == 0 ? kGood : kNotGood;
}

/// Shares the points that the page lacks: writes the shares, and submits them where that is wanted. The job
/// after them merges them into the store beside the page and makes the page.
int shareReport(const ReportCommand& command, const Commands& commands, SweepOptions points) {
  const ShareOptions& share = command.share;
  const GlobalOptions& global = commands.global;
  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  points.points.clear();
  const SharedPlan plan = planSweep(
      *device, techniques, points, [&](const std::filesystem::path& file) { return global.loadScene(file); },
      share.tasks, share.taskSeconds);
  return sharePlan(
      commands, share, plan,
      {.name = "report",
       .units = "points",
       .into = points.into,
       .mixed = [&] { return holdsOtherVersions(ResultsStore(points.into), techniques); },
       .exclusive = true,
       .mergeExclusive = true,
       .dropped = {"--store", "-o", "--out"},
       .afterMerge = [](const std::string& program, const std::string& typed,
                        const std::string&) { return fmt::format("exec {}{}\n", program, typed); }});
}

int report(const ReportCommand& command, const Commands& commands) {
  const GlobalOptions& global = commands.global;
  command.share.check(commands, "--store with a store of its own for each share",
                      !command.measure.options.store.empty());
  ReportOptions options = command.measure.asked(global);
  if ((command.share.isShare() || command.share.plans()) && options.budgetSeconds > 0.0)
    throw Error(
        "report --budget ends a report early; a share measures all of its points: expected one of both");
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
  if (command.share.isShare())
    return measureShare(command, global, sharedPoints(command, options, files.page));
  if (command.share.plans())
    return shareReport(command, commands, sharedPoints(command, options, files.page));
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
    printSummary(summary, options);
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
  all->measure.addBudgetTo(*command, "a point for each technique first, then what else there is time for");
  all->measure.display.addToneTo(*command);
  command
      ->add_option("--voxels", all->measure.options.voxelResolution,
                   "adds a section on the voxelizers at this resolution (default: none)")
      ->check(CLI::Range(1, 1024));
  addRepeatable(
      *command, "--equal-time", all->equalTimes,
      "a frame time of the table of equal time, such as 16ms; may be repeated (default: round numbers)");
  addRepeatable(*command, "--equal-error", all->equalErrors,
                "an error of the table of equal error; may be repeated (default: round numbers)");
  command->add_flag(
      "--brief", all->brief,
      "a page of one screen per scene, with the images of the default points alone; CSV and JSON "
      "hold everything");
  auto* json = command->add_flag("--json", all->json, "print the JSON in place of the table");
  command->add_flag("--csv", all->csv, "print the CSV in place of the table")->excludes(json);
  all->share.addTo(*command, "the --store of its own, without a page", /*hasStore=*/true);
  commands.onChosen(command, [=, &commands] { return report(*all, commands); });
}

}  // namespace lumivox::command
