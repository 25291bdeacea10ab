// stress: finds where each technique breaks.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>

#include "command.h"
#include "common/named_texts.h"
#include "common/outputs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/interruption.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/report.h"
#include "lumivox/experiment/sweep.h"
#include "lumivox/page/stress_page.h"
#include "lumivox/results/stress_cells.h"
#include "lumivox/stress/stress.h"
#include "measure_options.h"
#include "results_text.h"
#include "share_options.h"
#include "stress_text.h"

namespace lumivox::command {
namespace {

struct StressCommand {
  StressOptions options;
  ShareOptions share;
  bool json = false, list = false, worker = false;
  std::uint64_t workerMemory = 0;
  std::filesystem::path from;
};

/// The command line that starts this program as a worker.
std::vector<std::string> workerProgram(const GlobalOptions& global) {
  std::vector<std::string> words{std::filesystem::read_symlink("/proc/self/exe").string()};
  const std::vector<std::string> arguments = repeatArguments(global);
  words.insert(words.end(), arguments.begin(), arguments.end());
  words.insert(words.end(), {"--quiet", "stress", "--worker"});
  return words;
}

int listCases(const StressOptions& options, TechniqueSet& techniques, bool json) {
  const std::vector<StressJob> jobs = plannedStress(options, techniques);
  if (json) {
    Json list = Json::array();
    for (const StressJob& job : jobs)
      list.push_back({{"family", job.info.family},
                      {"case", job.info.name},
                      {"quick", job.info.quick},
                      {"pipeline", job.pipeline.string()},
                      {"technique", job.technique},
                      {"meaning", job.info.meaning}});
    printJson(list);
    return kGood;
  }
  std::vector<std::vector<std::string>> rows{{"Family", "Case", "Quick", "Pipelines", "Meaning"}};
  std::map<std::string, std::size_t> rowOf;
  std::map<std::string, int> pipelines;
  for (const StressJob& job : jobs) {
    ++pipelines[job.info.name];
    if (!rowOf.emplace(job.info.name, rows.size()).second) continue;
    rows.push_back({job.info.family, job.info.name, job.info.quick ? "quick" : "", "", job.info.meaning});
  }
  for (const auto& [name, row] : rowOf) rows[row][3] = std::to_string(pipelines[name]);
  print(textTable(rows, 2) + fmt::format("{} cases, {} cells\n", rows.size() - 1, jobs.size()));
  return kGood;
}

int tell(const StressSummary& summary, bool json) {
  if (json)
    print(stressCellsJson(summary.cells));
  else
    print(stressTable(summary.cells) + (summary.page.empty() ? "" : summary.page.string() + "\n"));
  return summary.sound() ? kGood : kNotGood;
}

/// Throws, before the work, if the page or the cells beside it cannot be written into the folder.
void checkOutput(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& inputs) {
  if (folder.empty()) return;
  Outputs()
      .add("-o", folder / "index.html", {".html"})
      .add("-o", folder / "index.json", {".json"})
      .check(inputs);
}

/// Prints the contents of a store without running anything.
int tellStored(const StressCommand& command, const GlobalOptions& global) {
  const StressOptions& options = command.options;
  if (!options.pipelines.empty() || !options.families.empty() || !options.cases.empty() || options.quick ||
      !options.store.empty())
    throw Error(
        "stress --from shows the contents of a store; of the other arguments only TECHNIQUE can be combined with it");
  CellFilter filter;
  filter.technique = options.technique;
  StressSummary summary;
  summary.cells = newestCells(ResultsStore(command.from, ResultsStore::Mode::read).stressCells(filter));
  if (summary.cells.empty())
    throw Error(command.from.string() + ": the store has no such cells of the stress battery");
  checkOutput(options.output, {command.from});
  if (!options.output.empty())
    summary.page = writeStressPage(options.output, summary.cells, global.commandLine);
  return tell(summary, command.json);
}

/// Shares the cells that the store lacks: writes the shares, and submits them where that is wanted.
int shareStress(const StressCommand& command, const Commands& commands, TechniqueSet& techniques,
                const StressOptions& options) {
  const ShareOptions& share = command.share;
  const SharedPlan plan = planStress(options, techniques, share.tasks, share.taskSeconds);
  SharedStore store{.name = "stress",
                    .units = "cells",
                    .into = options.into,
                    .mixed = [&] { return holdsOtherVersions(ResultsStore(options.into), techniques); },
                    .dropped = {"--store", "-o", "--out"}};
  if (!options.output.empty())
    store.afterMerge = [&](const std::string& program, const std::string&, const std::string& into) {
      return fmt::format("exec {} stress --from {} -o {}\n", program, into,
                         inSingleQuotes(options.output.string()));
    };
  return sharePlan(commands, share, plan, store);
}

int stress(const StressCommand& command, const Commands& commands) {
  const GlobalOptions& global = commands.global;
  command.share.check(commands, "--store with a store of its own for each share",
                      !command.options.store.empty());
  if (!command.from.empty()) return tellStored(command, global);
  TechniqueSet techniques = global.techniqueSet();
  StressOptions options = command.options;
  options.shard = command.share.shard();
  options.points = command.share.points;
  options.into = command.share.into;
  options.program = workerProgram(global);
  options.repeatArguments = repeatArguments(global);
  options.commandLine = global.commandLine;
  options.memoryBytes = global.memory;
  if (command.worker) {
    gpu::DeviceOptions device = global.deviceOptions();
    if (command.workerMemory > 0) {
      device.memoryBytes = command.workerMemory;
      options.program.insert(options.program.end(),
                             {"--worker-memory", std::to_string(command.workerMemory)});
    }
    serveStress({device, global.sceneLoad(), options.program, options.repeatArguments}, techniques);
    return kGood;
  }
  if (command.list) return listCases(options, techniques, command.json);
  if (command.share.plans()) {
    if (options.into.empty()) options.into = options.store;
    if (options.into.empty())
      throw Error("stress --slurm: expected --store with the store that the shares are merged into");
    options.points.clear();
    return shareStress(command, commands, techniques, options);
  }
  std::vector<std::filesystem::path> inputs = options.pipelines;
  inputs.push_back(options.store);
  checkOutput(options.output, inputs);
  Progress progress("stress", 0, "cells");
  options.progress = [&progress](const StressCell& cell, std::size_t done, std::size_t total,
                                 double secondsLeft) {
    const std::string what = fmt::format("{}, {}: {}", std::filesystem::path(cell.pipeline).stem().string(),
                                         cell.name, stressValueText(cell));
    // Stable and inapplicable cells appear only in the line of progress, unless --verbose is given.
    const bool well = cell.outcome == StressOutcome::stable || cell.outcome == StressOutcome::notApplicable;
    logMessage(well ? LogLevel::details : LogLevel::information, what);
    progress.show(done, total, secondsLeft, what);
  };
  InterruptionNote note;
  note.say(
      options.store.empty()
          ? "interrupted: nothing is kept without --store"
          : fmt::format(
                "interrupted: {} keeps the cells that have run; results list --stress shows them; the whole battery again: {}",
                options.store.string(), global.commandLine));
  const StressSummary summary = runStress(options, techniques);
  if (summary.leftOut > 0)
    logInformation("{} cells are held already or left to other shares", summary.leftOut);
  return tell(summary, command.json);
}

}  // namespace

void addStressCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "stress",
      "shows where each technique breaks: every pipeline on every extreme case, in separate processes");
  auto all = std::make_shared<StressCommand>();
  StressOptions& options = all->options;
  command->add_option("TECHNIQUE", options.technique,
                      "only pipelines that represent this technique (default: all)");
  addRepeatable(*command, "--family", options.families, "only cases of this family; may be repeated");
  addRepeatable(*command, "--case", options.cases,
                "only this case, quick or not; may contain '*'; may be repeated");
  takesNames(addRepeatable(*command, "--pipeline", options.pipelines,
                           "pipelines' texts or names (default: every committed one, voxelizers too); may be "
                           "repeated"),
             NamedText::pipeline);
  command->add_flag("--quick", options.quick, "the quick cases alone, at small sizes");
  addDuration(*command, "--time-limit", options.timeLimit,
              "time limit of one cell, such as 90s (default 60s with --quick, else 600s)");
  command
      ->add_option(
          "--workers", options.workers,
          "processes at the same time (default: one per processor on a software rasteriser, else one)")
      ->check(CLI::Range(1, 256));
  command->add_option("-o,--out", options.output,
                      "a folder for the page, its images and index.json (default: none)");
  command->add_option("--store", options.store,
                      "a results store that the cells are added to (default: none)");
  command->add_option("--from", all->from, "show the newest cells of this results store and run nothing");
  command->add_flag("--list", all->list, "only list the cases");
  command->add_flag("--json", all->json, "print JSON in place of the tables");
  command->add_flag("--worker", all->worker)->group("");  // for the battery itself
  command->add_option("--worker-memory", all->workerMemory)->group("");
  all->share.addTo(*command, "the --store of its own", /*hasStore=*/true);
  commands.onChosen(command, [=, &commands] { return stress(*all, commands); });
}

}  // namespace lumivox::command
