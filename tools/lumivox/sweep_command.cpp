// sweep: measures the points that a results store does not have yet.
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/sweep.h"
#include "lumivox/results/csv.h"
#include "lumivox/results/json.h"
#include "measure_options.h"
#include "results_text.h"
#include "share_options.h"

namespace lumivox::command {
namespace {

struct SweepCommand {
  MeasureOptions measure;
  ShareOptions share;
  bool plan = false, retryFailed = false, json = false, csv = false;
};

/// Shares the points that the store lacks: writes the shares, and submits them where that is wanted.
int shareSweep(const SweepCommand& command, const Commands& commands, gpu::Device& device,
               TechniqueSet& techniques, const SweepOptions& options) {
  const ShareOptions& share = command.share;
  const SharedPlan plan = planSweep(
      device, techniques, options,
      [&](const std::filesystem::path& scene) { return commands.global.loadScene(scene); }, share.tasks,
      share.taskSeconds);
  if (command.plan) {
    tellMissing(plan, "points", options.into);
    print(fmt::format("{} tasks\n", plan.shares.size()));
    return kGood;
  }
  return sharePlan(commands, share, plan,
                   {.name = "sweep",
                    .units = "points",
                    .into = options.into,
                    .mixed = [&] { return holdsOtherVersions(ResultsStore(options.into), techniques); },
                    .exclusive = true,
                    .dropped = {"--store"}});
}

int sweep(const SweepCommand& command, const Commands& commands) {
  const GlobalOptions& global = commands.global;
  command.share.check(commands, "--store with a store of its own for each share",
                      !command.measure.options.store.empty());
  SweepOptions options;
  options.measure = command.measure.asked(global);
  // Sweep texts are among the positional texts: they are moved out of the scenes.
  std::vector<std::filesystem::path>& scenes = options.measure.scenes;
  const auto isScene = [](const std::filesystem::path& file) { return kindOfText(file) != TextKind::sweep; };
  const auto texts = std::stable_partition(scenes.begin(), scenes.end(), isScene);
  options.texts.assign(texts, scenes.end());
  scenes.erase(texts, scenes.end());
  options.retryFailed = command.retryFailed;
  options.planOnly = command.plan;
  const std::filesystem::path file =
      options.measure.store.empty() ? ResultsStore::defaultFile() : options.measure.store;
  options.shard = command.share.shard();
  options.into = command.share.into;
  options.points = command.share.points;
  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  if (command.share.plans()) {
    if (options.into.empty()) options.into = file;
    options.points.clear();
    return shareSweep(command, commands, *device, techniques, options);
  }
  ResultsStore store(file);
  const SweepSummary summary =
      runSweep(*device, techniques, options, store,
               [&](const std::filesystem::path& scene) { return global.loadScene(scene); });
  if (command.json) {
    printJson({{"store", file.string()},
               {"measured", summary.measured},
               {"held", summary.held},
               {"failed", summary.failed},
               {"missing", summary.missing},
               {"unsuited", summary.unsuited},
               {"notes", summary.notes},
               {"runs", runsJson(summary.runs)}});
  } else if (command.csv) {
    print(runsCsv(summary.runs));
  } else {
    std::string text = summary.runs.empty() ? std::string() : runsTable(summary.runs);
    std::string below;
    for (const std::string& missing : summary.missing) below += "not measured yet: " + missing + "\n";
    for (const std::string& note : summary.notes) below += "note: " + note + "\n";
    for (const std::string& unsuited : summary.unsuited) below += "not run: " + unsuited + "\n";
    if (summary.leftToOthers > 0)
      below += fmt::format("left to other shares: {} points\n", summary.leftToOthers);
    const std::string done =
        options.planOnly
            ? fmt::format("{} points are missing", summary.missing.size())
            : fmt::format("{} measured{}", summary.measured,
                          summary.failed == 0 ? "" : fmt::format(", {} of them failed", summary.failed));
    below += fmt::format("{}, {} already in the store; {}\n", done, summary.held, file.string());
    print(text + remarks(below));
  }
  const bool good = std::all_of(summary.runs.begin(), summary.runs.end(), [](const StoredRun& run) {
    return run.point.failure.empty() && run.point.healthFindings.empty();
  });
  return good ? kGood : kNotGood;
}

}  // namespace

void addSweepCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "sweep", "measures every point of the pipelines' sweeps that is not in the results store yet");
  auto all = std::make_shared<SweepCommand>();
  all->measure.addTo(
      *command, "the results store (default: $LUMIVOX_RESULTS, else results.sqlite in the cache)",
      "the scenes' texts or names, and texts of sweeps that name scenes and pipelines themselves");
  command->add_flag("--plan", all->plan, "only list the missing points");
  command->add_flag("--retry-failed", all->retryFailed, "measure points that failed before once more");
  auto* json = command->add_flag("--json", all->json, "print JSON in place of the table");
  command->add_flag("--csv", all->csv, "print the runs as CSV in place of the table")->excludes(json);
  all->share.addTo(*command, "the --store of its own", /*hasStore=*/true);
  commands.onChosen(command, [=, &commands] { return sweep(*all, commands); });
}

}  // namespace lumivox::command
