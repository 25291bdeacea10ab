// tune: finds the best technique and parameters within a frame time or an error.
#include <fmt/format.h>

#include "common/outputs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/tune.h"
#include "lumivox/results/csv.h"
#include "lumivox/results/text.h"
#include "measure_options.h"

namespace lumivox::command {
namespace {

constexpr double kLargestErrorLimit = 1e37;

struct TuneCommand {
  MeasureOptions measure;
  TuneOptions tune;
  double error = 0.0, frameTimeSeconds = 0.0;
  bool hasError = false, json = false, csv = false;
  std::filesystem::path output;
};

/// The judged light in words.
std::string lightText(const TuneOptions& options) {
  return options.output == kWholeImage ? "the whole image" : fmt::format("output '{}'", options.output);
}

std::string verdictText(const TuneResult& result, const TuneOptions& options, const std::string& limit) {
  if (!result.winner)
    return fmt::format("nothing fits within {}; judged: {} of {}\n", limit, options.metric,
                       lightText(options));
  const auto numbersOf = [&](const TunedPoint& point) {
    return fmt::format("{} {} at {} ms", options.metric, threeDigits(point.tradeOff.error.value),
                       formatMilliseconds(point.tradeOff.timeMs.value));
  };
  const TunedPoint& winner = result.seen[*result.winner];
  const bool isWhole = options.output == kWholeImage;
  std::string text = fmt::format(
      "the best within {}: {}, {}\njudged: {}{}, {} against {}\n", limit,
      std::filesystem::path(winner.run.point.pipeline).stem().string(), numbersOf(winner), lightText(options),
      isWhole ? "" : fmt::format(" ({})", winner.component), options.metric, winner.reference);
  if (result.least != result.winner)
    text += fmt::format("the least {}, {}, cannot be told apart from it; of such points the {} is the best\n",
                        options.frameTimeMs ? "error" : "time", numbersOf(result.seen[*result.least]),
                        options.frameTimeMs ? "fastest" : "one with the least error");
  return text;
}

std::string resultText(const TuneResult& result, const TuneOptions& options) {
  std::vector<std::vector<std::string>> rows{{"Pipeline", "Parameters", "Frame ms", options.metric, ""}};
  for (std::size_t i = 0; i < result.seen.size(); ++i) {
    const TunedPoint& point = result.seen[i];
    if (!point.onFront && result.winner != i) continue;
    rows.push_back({std::filesystem::path(point.run.point.pipeline).stem().string(),
                    parametersText(point.run.identity.parameters), quartilesText(point.run.point.frameMs),
                    threeDigits(point.tradeOff.error.value),
                    result.winner == i ? "the best that fits"
                    : point.fits       ? "fits"
                                       : ""});
  }
  const std::string limit = options.frameTimeMs
                                ? fmt::format("{} ms", formatMilliseconds(*options.frameTimeMs))
                                : fmt::format("{} {}", options.metric, threeDigits(*options.errorLimit));
  std::string text = fmt::format("{} point{} measured{}; limit {}; only the Pareto front is shown\n",
                                 result.seen.size(), result.seen.size() == 1 ? "" : "s",
                                 result.exhausted ? ", every neighbour of the best among them"
                                 : result.usedUp  ? ", then the evaluations were used up"
                                                  : "",
                                 limit);
  text += verdictText(result, options, limit);
  for (const std::string& unsuited : result.unsuited) text += "not run: " + unsuited + "\n";
  if (result.leftOut > 0)
    text += noTimeText(result.leftOut, result.neededSeconds, options.measure.commandLine);
  return (rows.size() > 1 ? textTable(rows, 2) : std::string()) + remarks(text);
}

Json resultJson(const TuneResult& result, const TuneOptions& options) {
  Json seen = Json::array();
  for (const TunedPoint& point : result.seen)
    seen.push_back(
        {{"pipeline", point.run.point.pipeline},
         {"parameters", point.run.identity.parameters},
         {"time_ms", point.tradeOff.timeMs.value},
         {"time_uncertainty_ms", point.tradeOff.timeMs.uncertainty},
         {"error", point.tradeOff.error.value},
         {"error_uncertainty", point.tradeOff.error.uncertainty},
         {"undecided", !point.tradeOff.timeMs.enoughRepeats || !point.tradeOff.error.enoughRepeats},
         {"component", point.component},
         {"reference", point.reference},
         {"on_front", point.onFront},
         {"fits", point.fits},
         {"command", point.run.point.command}});
  return {{"metric", options.metric},
          {"output", options.output},
          {"seen", seen},
          {"winner", result.winner ? Json(*result.winner) : Json(nullptr)},
          {"least", result.least ? Json(*result.least) : Json(nullptr)},
          {"exhausted", result.exhausted},
          {"left_out", result.leftOut},
          {"unsuited", result.unsuited}};
}

int tuneScene(const TuneCommand& command, const GlobalOptions& global) {
  TuneOptions options = command.tune;
  options.measure = command.measure.asked(global, "tuning", "points at most");
  if (command.frameTimeSeconds > 0.0) options.frameTimeMs = 1000.0 * command.frameTimeSeconds;
  if (command.hasError) options.errorLimit = command.error;
  std::vector<std::filesystem::path> inputs = options.measure.scenes;
  inputs.insert(inputs.end(), options.measure.pipelines.begin(), options.measure.pipelines.end());
  inputs.push_back(options.measure.store.empty() ? ResultsStore::defaultFile() : options.measure.store);
  const Outputs outputs =
      Outputs().add("-o", command.output, {".pipeline"}, Outputs::Endings::otherKindsRefused);
  outputs.check(inputs);
  options.measure.allRead = [&] { outputs.requireUnread(); };
  ResultsStore store(options.measure.store.empty() ? ResultsStore::defaultFile() : options.measure.store);
  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  const TuneResult result = tune(*device, techniques, options, store,
                                 [&](const std::filesystem::path& scene) { return global.loadScene(scene); });
  if (result.winner && !command.output.empty()) writeFileAtomically(command.output, result.pipelineText);
  if (command.json) {
    printJson(resultJson(result, options));
  } else if (command.csv) {
    std::vector<StoredRun> runs;
    for (const TunedPoint& point : result.seen) runs.push_back(point.run);
    print(runsCsv(runs));
  } else {
    print(resultText(result, options) +
          (result.winner && !command.output.empty() ? command.output.string() + "\n" : std::string()));
  }
  return result.winner ? kGood : kNotGood;
}

}  // namespace

void addTuneCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "tune",
      "finds the technique and parameters with the least error within a frame time, or the least time within an error");
  auto all = std::make_shared<TuneCommand>();
  all->measure.addTo(*command,
                     "the results store (default: $LUMIVOX_RESULTS, else results.sqlite in the cache)");
  auto* frameTime =
      addDuration(*command, "--frame-time", all->frameTimeSeconds, "time limit of a frame, such as 16ms");
  all->measure.addBudgetTo(*command, "a point that would end beyond it is not begun");
  auto* error = command->add_option_function<double>(
      "--error",
      [all](double value) {
        all->error = value;
        all->hasError = true;
      },
      "error limit, in the unit of the metric");
  error->check(numberBetween(0.0, kLargestErrorLimit));
  frameTime->excludes(error);
  command->add_option("--metric", all->tune.metric,
                      "flip (default), rmse, relative_mse, percentile95, flip_ldr, ...");
  command->add_option("--output", all->tune.output,
                      "the pipelines' output that is judged (default: the whole image)");
  command->add_flag("--bias", all->tune.bias,
                    "judge against the technique's own model (one bounce) in place of full transport");
  command->add_option("--evaluations", all->tune.evaluations, "most points to measure (default 60)")
      ->check(CLI::Range(1, 100000));
  command->add_option("-o,--out", all->output,
                      "writes the best pipeline's text, with its parameters as defaults");
  auto* json = command->add_flag("--json", all->json, "print JSON in place of the table");
  command->add_flag("--csv", all->csv, "print all examined points as CSV in place of the table")
      ->excludes(json);
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return tuneScene(*all, global); });
}

}  // namespace lumivox::command
