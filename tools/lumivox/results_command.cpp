// results: lists, exports, merges, imports and removes the contents of a results store, and compares its
// pipelines. compare-runs: compares runs of the same points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "command.h"
#include "common/outputs.h"
#include "comparison_text.h"
#include "lumivox/analysis/changes.h"
#include "lumivox/analysis/comparison.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/report.h"
#include "lumivox/results/csv.h"
#include "lumivox/results/json.h"
#include "lumivox/results/stress_cells.h"
#include "measure_options.h"
#include "results_text.h"

namespace lumivox::command {
namespace {

struct ResultsCommand {
  std::filesystem::path store, output;
  RunFilter filter;
  bool failed = false, good = false, stress = false;
  CellFilter cells;
  std::string outcome;
  std::string format = "csv";
  std::vector<std::filesystem::path> others;
  bool all = false, dryRun = false, json = false, mixed = false;
  std::string component, metric = kDefaultMetric, against;  ///< empty: the default
  std::vector<std::string> frameTimes, errors;

  std::filesystem::path file() const { return store.empty() ? ResultsStore::defaultFile() : store; }
  RunFilter asked() const {
    RunFilter result = filter;
    if (failed || good) result.failed = failed;
    return result;
  }
  /// The filter of cells, by the same options for pipeline, device, day and number as that of runs.
  CellFilter askedCells() const {
    CellFilter result = cells;
    result.pipeline = filter.pipeline;
    result.device = filter.device;
    result.since = filter.since;
    result.ids = filter.ids;
    if (!outcome.empty()) result.outcome = stressOutcomeNamed(outcome);
    RunFilter rest = filter;
    rest.pipeline = rest.device = rest.since = {};
    rest.ids = {};
    if (!rest.everything() || failed || good)
      throw Error(
          "--scene, --set, --failed and --good choose runs; with --stress expected --family, --case, "
          "--technique, --pipeline, --outcome, --on, --since or --run");
    return result;
  }
  void addStressTo(CLI::App& app) {
    auto* flag = app.add_flag("--stress", stress, "cells of the stress battery in place of runs");
    app.add_option("--family", cells.family, "only cells of this family of cases")->needs(flag);
    app.add_option("--case", cells.name, "only cells of this case")->needs(flag);
    app.add_option("--technique", cells.technique, "only cells of pipelines that represent this technique")
        ->needs(flag);
    app.add_option("--outcome", outcome, "only cells with this outcome")
        ->needs(flag)
        ->check(CLI::IsMember({"stable", "biased", "diverges", "refused", "not_applicable", "broken"}));
  }
  void addStoreTo(CLI::App& app) {
    app.add_option("--store", store,
                   "the results store (default: $LUMIVOX_RESULTS, else results.sqlite in the cache)");
  }
  void addFilterTo(CLI::App& app) {
    addStoreTo(app);
    app.add_option("--scene", filter.scene, "only runs of this scene: file, its stem, or title");
    app.add_option("--pipeline", filter.pipeline, "only runs of this pipeline: file, its stem, or title");
    addRepeatable(app, "--set", filter.parameters, "only runs with this parameter, as name=value");
    app.add_option("--on", filter.device, "only runs whose device's name contains this");
    app.add_option("--since", filter.since, "only runs from this day on, such as 2026-01-31");
    app.add_option("--run", filter.ids, "only the run with this number; may be repeated")
        ->allow_extra_args(false);
    auto* onlyFailed = app.add_flag("--failed", failed, "only runs that failed");
    app.add_flag("--good", good, "only runs that did not fail")->excludes(onlyFailed);
  }
};

std::string cellsList(const std::vector<StressCell>& cells) {
  std::vector<std::vector<std::string>> rows{
      {"Cell", "Created", "Pipeline", "Family", "Case", "Size", "Outcome", "Limit", "Seconds"}};
  for (const StressCell& cell : cells)
    rows.push_back({std::to_string(cell.id), cell.created,
                    std::filesystem::path(cell.pipeline).stem().string(), cell.family, cell.name, cell.size,
                    stressValueText(cell), cell.measure.empty() ? "" : threeDigits(cell.limit),
                    threeDigits(cell.seconds)});
  return cells.empty() ? std::string() : textTable(rows);
}

/// The number of chosen runs; if there is none, the scenes and pipelines in the store.
std::string countText(const std::vector<StoredRun>& chosen, const ResultsStore& store) {
  std::string text = fmt::format("{} runs; {}\n", chosen.size(), store.file().string());
  if (!chosen.empty()) return text;
  std::set<std::string> scenes, pipelines;
  for (const StoredRun& run : store.runs()) {
    scenes.insert(std::filesystem::path(run.point.scene).stem().string());
    pipelines.insert(std::filesystem::path(run.point.pipeline).stem().string());
  }
  if (scenes.empty()) return text + "the store is empty\n";
  return text + fmt::format("it has runs of the scenes {}; of the pipelines {}\n", fmt::join(scenes, ", "),
                            fmt::join(pipelines, ", "));
}

int listResults(const ResultsCommand& command) {
  const ResultsStore store(command.file(), ResultsStore::Mode::read);
  if (command.stress) {
    const std::vector<StressCell> cells = store.stressCells(command.askedCells());
    print(command.json
              ? stressCellsJson(cells)
              : cellsList(cells) + fmt::format("{} cells; {}\n", cells.size(), store.file().string()));
    return kGood;
  }
  const std::vector<StoredRun> runs = store.runs(command.asked());
  if (command.json) {
    printJson(runsJson(runs));
  } else {
    print((runs.empty() ? std::string() : runsTable(runs)) + countText(runs, store));
  }
  return kGood;
}

/// The component of --component. Error, with the nearest, for an unknown one.
std::string componentNamed(const std::string& asked) {
  if (asked == kWholeImage) return name(Contributes::final);
  std::vector<std::string> known = comparableComponents();
  known.back() = kWholeImage;
  if (std::find(known.begin(), known.end(), asked) != known.end()) return asked;
  const std::string nearest = nearestWord(asked, known);
  throw Error(fmt::format("--component '{}': expected one of {}{}", asked, fmt::join(known, ", "),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

/// The comparison of --component. Without the option, the one that a report shows first, then that of the
/// whole image.
std::vector<PipelineComparison> askedComparisons(const ResultsCommand& command,
                                                 const std::vector<const ReportPoint*>& points,
                                                 const ComparisonLimits& limits) {
  const std::string whole = name(Contributes::final);
  // A component is judged against the techniques' own model, the whole image against full transport.
  const auto compared = [&](const std::string& component) {
    const bool bias = command.against.empty() ? component != whole : command.against == "bias";
    return comparePipelines(points, component, bias, command.metric, limits);
  };
  if (!command.component.empty()) return {compared(componentNamed(command.component))};
  const std::vector<PipelineComparison> all = compareComponents(points, {command.metric}, limits);
  const std::optional<std::size_t> led = ledComparison(all);
  std::vector<PipelineComparison> asked;
  if (led && all[*led].component != whole) asked.push_back(compared(all[*led].component));
  asked.push_back(compared(whole));
  return asked;
}

int comparePipelinesOf(const ResultsCommand& command, ComparisonTable table) {
  requireErrorMetric(command.metric);
  ComparisonLimits limits;
  for (const std::string& text : command.frameTimes)
    limits.frameTimesMs.push_back(1000.0 * secondsOf("--frame-time", text));
  for (const std::string& text : command.errors) limits.errors.push_back(positiveNumberOf("--error", text));
  if (!command.component.empty()) componentNamed(command.component);
  const ResultsStore store(command.file(), ResultsStore::Mode::read);
  const std::vector<StoredRun> runs = store.runs(command.asked());
  std::string text;
  Json list = Json::array();
  for (const ComparableRuns& group : comparableRuns(runs)) {
    std::vector<const ReportPoint*> points;
    for (const StoredRun* run : group.runs) points.push_back(&run->point);
    if (!group.runs.empty()) limits.floor = timeFloorOf(store.controls(group.runs.front()->identity));
    text += group.title + "\n";
    for (const PipelineComparison& comparison : askedComparisons(command, points, limits)) {
      text += comparison.points.empty()
                  ? fmt::format(
                        "no run has a {} of {}\n", command.metric,
                        comparison.component == name(Contributes::final) ? kWholeImage : comparison.component)
                  : comparisonText(comparison, table);
      Json json = toJson(comparison);
      json["runs"] = group.title;
      json["passed_over"] = group.passedOver;
      list.push_back(std::move(json));
    }
    text += (group.passedOver == 0 ? ""
                                   : fmt::format("{} older or failed runs passed over\n", group.passedOver)) +
            "\n";
  }
  if (command.json)
    printJson(list);
  else
    print(text + countText(runs, store));
  return kGood;
}

int exportResults(const ResultsCommand& command) {
  Outputs()
      .add("-o", command.output, {"." + command.format}, Outputs::Endings::otherKindsRefused)
      .check({command.file()});
  const ResultsStore store(command.file(), ResultsStore::Mode::read);
  std::string text, count;
  if (command.stress) {
    const std::vector<StressCell> cells = store.stressCells(command.askedCells());
    text = command.format == "json" ? stressCellsJson(cells) : stressCellsCsv(cells);
    count = fmt::format("{} cells", cells.size());
  } else {
    const std::vector<StoredRun> runs = store.runs(command.asked());
    text = command.format == "json" ? runsJson(runs).dump(1) + "\n" : runsCsv(runs);
    count = fmt::format("{} runs", runs.size());
  }
  if (command.output.empty()) {
    print(text);
  } else {
    writeFileAtomically(command.output, text);
    print(fmt::format("{}; {}\n", count, command.output.string()));
  }
  return kGood;
}

std::string countText(const MergeCount& count, const std::filesystem::path& file) {
  return fmt::format("{} runs, {} stress cells, {} peak rates from {}\n", count.runs, count.cells,
                     count.peakRates, file.string());
}

int mergeResults(const ResultsCommand& command) {
  // The first is opened before the store is made.
  const ResultsStore first(command.others.front(), ResultsStore::Mode::read);
  ResultsStore store(command.file());
  const std::vector<MergeCount> counts = store.merge(command.others, command.mixed);
  for (std::size_t i = 0; i < counts.size(); ++i) print(countText(counts[i], command.others[i]));
  return kGood;
}

int importResults(const ResultsCommand& command) {
  ResultsStore store(command.file());
  for (const std::filesystem::path& file : command.others) print(countText(store.import(file), file));
  return kGood;
}

int removeCells(const ResultsCommand& command) {
  const CellFilter filter = command.askedCells();
  if (filter.everything() != command.all)
    throw Error(command.all ? "results remove --stress: --all removes every cell; it cannot be restricted"
                            : "results remove --stress: it would remove every cell; say which, or --all");
  ResultsStore store(command.file(), command.dryRun ? ResultsStore::Mode::read : ResultsStore::Mode::write);
  if (command.dryRun) {
    const std::vector<StressCell> cells = store.stressCells(filter);
    print(cellsList(cells) + fmt::format("{} cells would be removed\n", cells.size()));
  } else {
    print(fmt::format("{} cells removed\n", store.removeCells(filter)));
  }
  return kGood;
}

int removeResults(const ResultsCommand& command) {
  if (command.stress) return removeCells(command);
  const RunFilter filter = command.asked();
  if (filter.everything() && !command.all)
    throw Error("results remove: it would remove every run; say which, or --all");
  if (!filter.everything() && command.all)
    throw Error("results remove: --all removes every run; it cannot be restricted");
  ResultsStore store(command.file(), command.dryRun ? ResultsStore::Mode::read : ResultsStore::Mode::write);
  if (command.dryRun) {
    const std::vector<StoredRun> runs = store.runs(filter);
    print((runs.empty() ? std::string() : runsTable(runs)) +
          fmt::format("{} runs would be removed\n", runs.size()));
  } else {
    print(fmt::format("{} runs removed\n", store.remove(filter)));
  }
  return kGood;
}

/// Whether A or B of compare-runs is a store; if not, it is the number of a run in --store.
bool isStore(const std::string& text) {
  return text.find_first_not_of("0123456789") != std::string::npos;
}

std::filesystem::path storeOf(const std::string& text, const ResultsCommand& command) {
  return isStore(text) ? std::filesystem::path(text) : command.file();
}

/// The largest difference between times of repeated measurements, over the machines of a store's runs.
TimeFloor floorOf(const std::filesystem::path& file) {
  const ResultsStore store(file, ResultsStore::Mode::read);
  TimeFloor floor;
  std::set<std::vector<std::string>> seen;
  for (const StoredRun& run : store.runs()) {
    const RunIdentity& where = run.identity;
    if (seen.insert({where.device, where.driver, where.shaderInput, where.host}).second)
      floor = larger(floor, timeFloorOf(store.controls(where)));
  }
  return floor;
}

/// The runs of A or B of compare-runs: those of a store, or one run of --store.
std::vector<StoredRun> runsOf(const std::string& text, const ResultsCommand& command) {
  if (isStore(text)) return ResultsStore(text, ResultsStore::Mode::read).runs(command.asked());
  const ResultsStore store(command.file(), ResultsStore::Mode::read);
  RunFilter filter;
  filter.ids = {std::strtoll(text.c_str(), nullptr, 10)};
  std::vector<StoredRun> runs = store.runs(filter);
  if (runs.empty())
    throw Error(
        fmt::format("{}: there is no run {}; lumivox results list shows them", store.file().string(), text));
  return runs;
}

Json changesJson(const RunComparison& comparison, const TimeFloor& floor) {
  Json list = Json::array();
  for (const RunChange& change : comparison.changes)
    list.push_back({{"point", change.point},
                    {"quantity", change.quantity},
                    {"before", change.before.value},
                    {"before_uncertainty", change.before.uncertainty},
                    {"after", change.after.value},
                    {"after_uncertainty", change.after.uncertainty},
                    {"sigmas", change.sigmas},
                    {"significant", change.significant},
                    {"undecided", change.undecided},
                    {"better", change.better}});
  return {{"compared", comparison.compared},
          {"least_time_share", std::max(kSignificantTimeShare, floor.frame)},
          {"controls", floor.controls},
          {"only_before", comparison.onlyBefore},
          {"only_after", comparison.onlyAfter},
          {"incomparable", comparison.incomparable},
          {"changes", list}};
}

int compareRuns(const ResultsCommand& command, const std::string& before, const std::string& after) {
  const std::filesystem::path first = storeOf(before, command), second = storeOf(after, command);
  const TimeFloor floor = first == second ? floorOf(first) : larger(floorOf(first), floorOf(second));
  const RunComparison comparison = compareResults(runsOf(before, command), runsOf(after, command), floor);
  if (command.json) {
    printJson(changesJson(comparison, floor));
    return kGood;
  }
  std::string text;
  std::vector<std::vector<std::string>> rows;
  const auto closePoint = [&](const std::string& point) {
    if (rows.size() > 1) text += point + "\n" + textTable(rows);
    rows = {{"  Quantity", "Before", "After", "Change", "Sigmas", ""}};
  };
  std::string point;
  for (const RunChange& change : comparison.changes) {
    if (change.point != point) closePoint(point);
    point = change.point;
    if (!change.significant && !command.all) continue;
    const double share =
        change.before.value != 0.0 ? change.after.value / change.before.value - 1.0 : std::nan("");
    rows.push_back({"  " + change.quantity,
                    fmt::format("{:.3g} ± {:.1g}", change.before.value, change.before.uncertainty),
                    fmt::format("{:.3g} ± {:.1g}", change.after.value, change.after.uncertainty),
                    std::isnan(share) ? std::string("-") : fmt::format("{:+.1f} %", 100.0 * share),
                    std::isinf(change.sigmas) ? std::string("exact") : fmt::format("{:.1f}", change.sigmas),
                    change.undecided      ? "undecided"
                    : !change.significant ? "not significant"
                    : change.better       ? "better"
                                          : "worse"});
  }
  closePoint(point);
  const auto significant = std::count_if(comparison.changes.begin(), comparison.changes.end(),
                                         [](const RunChange& change) { return change.significant; });
  text += fmt::format("{} point{} compared, {} of {} quantities changed significantly\n", comparison.compared,
                      comparison.compared == 1 ? "" : "s", significant, comparison.changes.size());
  const auto undecided = std::count_if(comparison.changes.begin(), comparison.changes.end(),
                                       [](const RunChange& change) { return change.undecided; });
  if (undecided > 0)
    text += fmt::format("{} of {} quantities are undecided: fewer than {} timed frames or seeds\n", undecided,
                        comparison.changes.size(), kLeastRepeats);
  text +=
      floor.controls > 0
          ? fmt::format("times count as changed beyond {:.1f} %: {} points were timed twice\n",
                        100.0 * std::max(kSignificantTimeShare, floor.frame), floor.controls)
          : fmt::format("times count as changed beyond {:.0f} %: no point was timed twice on this machine\n",
                        100.0 * kSignificantTimeShare);
  for (const std::string& one : comparison.onlyBefore) text += "only before: " + one + "\n";
  for (const std::string& one : comparison.onlyAfter) text += "only after: " + one + "\n";
  for (const std::string& one : comparison.incomparable) text += "not compared: " + one + "\n";
  print(text);
  return kGood;
}

}  // namespace

void addResultsCommands(Commands& commands) {
  auto* results = commands.app.add_subcommand("results", "shows and changes the contents of a results store");
  results->require_subcommand(1);
  results->fallthrough();
  auto command = std::make_shared<ResultsCommand>();
  const auto add = [&](const char* name, const char* meaning, auto work) {
    auto* subcommand = results->add_subcommand(name, meaning);
    commands.onChosen(subcommand, [=] { return work(*command); });
    return subcommand;
  };
  auto* list = add("list", "the runs, as a table", listResults);
  command->addFilterTo(*list);
  command->addStressTo(*list);
  list->add_flag("--json", command->json, "print everything as JSON in place of the table");
  auto* exported = add("export", "the runs with every number, as CSV or JSON", exportResults);
  command->addFilterTo(*exported);
  command->addStressTo(*exported);
  exported->add_option("--format", command->format, "csv or json")->check(CLI::IsMember({"csv", "json"}));
  exported->add_option("-o,--out", command->output, "the file (default: standard output)");
  const auto addComparison = [&](const char* name, const char* meaning, ComparisonTable table) {
    auto* subcommand =
        add(name, meaning, [table](const ResultsCommand& asked) { return comparePipelinesOf(asked, table); });
    command->addFilterTo(*subcommand);
    subcommand->add_option(
        "--component", command->component,
        "indirect_diffuse, direct, ..., whole_image (default: the indirect component that most "
        "pipelines have, then whole_image)");
    subcommand->add_option("--metric", command->metric,
                           "flip (default), rmse, relative_mse, percentile95, ...");
    subcommand
        ->add_option("--against", command->against,
                     "misses (full transport; default for whole_image) or bias (the own model; default "
                     "for components)")
        ->check(CLI::IsMember({"misses", "bias"}));
    subcommand->add_flag("--json", command->json, "print everything as JSON in place of the table");
    return subcommand;
  };
  addComparison("front", "lists the pipelines that no other beats in both time and error",
                ComparisonTable::front);
  auto* equalTime = addComparison("equal-time", "the error that each pipeline reaches within a frame time",
                                  ComparisonTable::equalTime);
  addRepeatable(*equalTime, "--frame-time", command->frameTimes,
                "a frame time, such as 16ms; may be repeated (default: round numbers)");
  refuseFrameTimeAsBudget(*equalTime);
  addRepeatable(*addComparison("equal-error", "the time that each pipeline needs for an error",
                               ComparisonTable::equalError),
                "--error", command->errors, "an error; may be repeated (default: round numbers)");
  auto* merge =
      add("merge", "copies the runs, stress cells and peak rates that this store lacks from other stores",
          mergeResults);
  command->addStoreTo(*merge);
  merge->add_option("STORE", command->others, "the other stores; their order does not matter")->required();
  merge->add_flag("--mixed", command->mixed,
                  "also of different versions of Lumivox or of a technique (default: refused)");
  auto* import =
      add("import", "copies the runs, stress cells and peak rates of stores that an earlier version wrote",
          importResults);
  command->addStoreTo(*import);
  import->add_option("STORE", command->others, "the stores of earlier versions")->required();
  auto* remove = add("remove", "removes runs", removeResults);
  command->addFilterTo(*remove);
  command->addStressTo(*remove);
  remove->add_flag("--all", command->all, "every run");
  remove->add_flag("--dry-run", command->dryRun, "only list them");

  auto* compare = commands.app.add_subcommand(
      "compare-runs", "lists significant changes between two stored runs, or two results stores");
  auto before = std::make_shared<std::string>(), after = std::make_shared<std::string>();
  compare->add_option("BEFORE", *before, "a results store, or the number of a run in --store")->required();
  compare->add_option("AFTER", *after, "the same")->required();
  command->addFilterTo(*compare);
  compare->add_flag("--all", command->all, "also list insignificant changes");
  compare->add_flag("--json", command->json, "print JSON in place of the table");
  commands.onChosen(compare, [=] { return compareRuns(*command, *before, *after); });
}

}  // namespace lumivox::command
