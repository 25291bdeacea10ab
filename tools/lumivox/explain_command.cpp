// explain: what a run leaves out, why, and what that saves.
#include <fmt/format.h>

#include "command.h"
#include "lumivox/base/file.h"
#include "lumivox/report/report.h"

namespace lumivox::command {
namespace {

struct ExplainCommand {
  std::filesystem::path scene, pipeline;
  RunOptions run;
  int repeats = 5;
  bool json = false;
};

Json timeAsJson(const TimingStatistics& time) {
  return {{"median", time.median},
          {"lower_quartile", time.lowerQuartile},
          {"upper_quartile", time.upperQuartile},
          {"repeats", time.repeats}};
}

Json asJson(const PruningRecord& record) {
  const Explanation& explanation = record.explanation;
  Json json = {{"scene", record.scene},
               {"pipeline", record.pipeline},
               {"passes_kept", explanation.passesKept},
               {"passes_total", explanation.passesTotal},
               {"variants",
                {{"possible", explanation.variantsPossible},
                 {"compiled", explanation.variantsCompiled},
                 {"needed", explanation.variantsNeeded}}},
               {"frame_ms", timeAsJson(record.prunedMs)},
               {"frame_ms_keep_everything", timeAsJson(record.unprunedMs)},
               {"saved_share", record.savedShare()},
               {"next_frame_ms", timeAsJson(record.nextPrunedMs)},
               {"next_frame_ms_keep_everything", timeAsJson(record.nextUnprunedMs)},
               {"saved_share_next", record.savedShareNext()},
               {"bytes", record.prunedBytes},
               {"bytes_keep_everything", record.unprunedBytes},
               {"same_picture", record.samePicture}};
  json["left_out"] = Json::array();
  for (const LeftOut& one : explanation.leftOut)
    json["left_out"].push_back({{"level", name(one.level)},
                                {"what", one.what},
                                {"why", one.why},
                                {"pass", one.pass},
                                {"saved_bytes", one.savedBytes},
                                {"saved_ms", one.savedMs}});
  json["passes"] = Json::array();
  for (const std::string& pass : record.passOrder) {
    const auto pruned = record.prunedPassMs.find(pass), unpruned = record.unprunedPassMs.find(pass);
    json["passes"].push_back(
        {{"pass", pass},
         {"ms", pruned == record.prunedPassMs.end() ? Json(nullptr) : timeAsJson(pruned->second)},
         {"ms_keep_everything",
          unpruned == record.unprunedPassMs.end() ? Json(nullptr) : timeAsJson(unpruned->second)}});
  }
  return json;
}

std::string asText(const PruningRecord& record) {
  const Explanation& explanation = record.explanation;
  std::vector<std::vector<std::string>> leftOut{{"Level", "Left out", "Memory", "ms", "Why"}};
  for (const LeftOut& one : explanation.leftOut)
    leftOut.push_back({name(one.level), one.what, one.savedBytes == 0 ? "" : formatBytes(one.savedBytes),
                       one.savedMs == 0.0 ? "" : formatMilliseconds(one.savedMs), one.why});
  std::vector<std::vector<std::string>> passes{{"Pass", "ms", "ms, everything kept"}};
  for (const std::string& pass : record.passOrder) {
    const auto pruned = record.prunedPassMs.find(pass), unpruned = record.unprunedPassMs.find(pass);
    passes.push_back(
        {pass, pruned == record.prunedPassMs.end() ? "left out" : formatMilliseconds(pruned->second.median),
         unpruned == record.unprunedPassMs.end() ? "-" : formatMilliseconds(unpruned->second.median)});
  }
  passes.push_back({"whole frame", formatMilliseconds(record.prunedMs.median),
                    formatMilliseconds(record.unprunedMs.median)});
  passes.push_back({"next frame, camera moving", formatMilliseconds(record.nextPrunedMs.median),
                    formatMilliseconds(record.nextUnprunedMs.median)});
  return textTable(leftOut) + "\n" + textTable(passes) +
         fmt::format("\n{} of {} passes kept; variants: {} possible, {} compiled, {} needed\n",
                     explanation.passesKept, explanation.passesTotal, explanation.variantsPossible,
                     explanation.variantsCompiled, explanation.variantsNeeded) +
         fmt::format(
             "{} of the time of a first frame saved, {} of the next ones with a moving camera; memory of the "
             "passes "
             "{} in place of {}; same picture: {}\n",
             formatPercent(record.savedShare()), formatPercent(record.savedShareNext()),
             formatBytes(record.prunedBytes), formatBytes(record.unprunedBytes),
             record.samePicture ? "yes" : "NO");
}

int explain(const ExplainCommand& command, const GlobalOptions& global) {
  const Pipeline pipeline = Pipeline::load(command.pipeline);
  TechniqueSet techniques = global.techniqueSet();
  checkPipeline(pipeline, techniques);
  RenderOptions options = command.run.renderOptions(pipeline);
  const Scene scene = global.loadScene(command.scene);
  const auto device = global.openDevice();
  if (options.width == 0 && device->info().software) {
    constexpr int kSoftwarePixels = 128;  // as in the report: enough to measure by
    const Camera& camera = scene.camera(options.camera);
    std::tie(options.width, options.height) = reducedResolution(camera.width, camera.height, kSoftwarePixels);
  }
  const PruningRecord record =
      measurePruning(*device, techniques, scene, pipeline, options, command.run.time, command.repeats);
  if (command.json)
    printJson(asJson(record));
  else
    print(asText(record));
  return record.samePicture ? kGood : kNotGood;
}

}  // namespace

void addExplainCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "explain", "lists what a run leaves out, why, and what that saves, measured");
  auto options = std::make_shared<ExplainCommand>();
  command->add_option("SCENE", options->scene, "the scene's text")->required();
  command->add_option("PIPELINE", options->pipeline, "the pipeline's text")->required();
  options->run.addTo(*command);
  command->add_option("--repeats", options->repeats, "timed frames of each kind (default 5)")
      ->check(CLI::Range(1, 10000));
  command->add_flag("--json", options->json, "print JSON");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return explain(*options, global); });
}

}  // namespace lumivox::command
