// explain: what a run leaves out, why, and what that saves; over many scenes and pipelines as a matrix.
#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/report/needs.h"

namespace lumivox::command {
namespace {

struct ExplainCommand {
  std::vector<std::filesystem::path> texts;      ///< scenes and pipelines, as they come
  std::vector<std::filesystem::path> pipelines;  ///< of --pipeline
  RunOptions run;
  int repeats = 5;
  bool all = false, noTimes = false, json = false;
};

Json timeAsJson(const TimingStatistics& time) {
  if (time.repeats == 0) return nullptr;
  return {{"median", time.median},
          {"lower_quartile", time.lowerQuartile},
          {"upper_quartile", time.upperQuartile},
          {"repeats", time.repeats}};
}

Json shareAsJson(const PruningRecord& record, double share) {
  return record.prunedMs.repeats == 0 ? Json(nullptr) : Json(share);
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
               {"saved_share", shareAsJson(record, record.savedShare())},
               {"next_frame_ms", timeAsJson(record.nextPrunedMs)},
               {"next_frame_ms_keep_everything", timeAsJson(record.nextUnprunedMs)},
               {"saved_share_next", shareAsJson(record, record.savedShareNext())},
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

std::string leftOutText(const Explanation& explanation) {
  std::vector<std::vector<std::string>> leftOut{{"Level", "Left out", "Memory", "ms", "Why"}};
  for (const LeftOut& one : explanation.leftOut)
    leftOut.push_back({name(one.level), one.what, one.savedBytes == 0 ? "" : formatBytes(one.savedBytes),
                       one.savedMs == 0.0 ? "" : formatMilliseconds(one.savedMs), one.why});
  return textTable(leftOut);
}

std::string passText(const PruningRecord& record) {
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
  return textTable(passes);
}

std::string asText(const PruningRecord& record) {
  const Explanation& explanation = record.explanation;
  const bool timed = record.prunedMs.repeats > 0;
  std::string text = leftOutText(explanation) + "\n";
  if (timed) text += passText(record) + "\n";
  text += fmt::format("{} of {} passes kept; variants: {} possible, {} compiled, {} needed\n",
                      explanation.passesKept, explanation.passesTotal, explanation.variantsPossible,
                      explanation.variantsCompiled, explanation.variantsNeeded);
  if (timed)
    text += fmt::format("{} of the time of a first frame saved, {} of the next ones with a moving camera; ",
                        formatPercent(record.savedShare()), formatPercent(record.savedShareNext()));
  return text + fmt::format("memory of the passes {} in place of {}; same picture: {}\n",
                            formatBytes(record.prunedBytes), formatBytes(record.unprunedBytes),
                            record.samePicture ? "yes" : "NO");
}

/// "42.1/57.5 MiB", or "900.0 KiB/1.2 MiB" where the units differ.
std::string bytesText(std::uint64_t first, std::uint64_t second) {
  std::string a = formatBytes(first);
  const std::string b = formatBytes(second);
  if (const std::size_t unit = a.rfind(' '); a.substr(unit) == b.substr(b.rfind(' '))) a.erase(unit);
  return a + "/" + b;
}

/// "9/13 16/192/226 42.1/57.5 MiB": passes kept of all; variants needed, compiled, possible; memory, and
/// with everything kept. With times: of a first frame and of a later one.
std::string cellText(const NeededCell& cell) {
  if (!cell.record) return cell.failed ? "failed" : "absent";
  const PruningRecord& record = *cell.record;
  const Explanation& explanation = record.explanation;
  std::string text =
      fmt::format("{}/{} {}/{}/{} {}", explanation.passesKept, explanation.passesTotal,
                  explanation.variantsNeeded, explanation.variantsCompiled, explanation.variantsPossible,
                  bytesText(record.prunedBytes, record.unprunedBytes));
  if (record.prunedMs.repeats > 0)
    text += fmt::format(" {}/{} {}/{} ms", formatMilliseconds(record.prunedMs.median),
                        formatMilliseconds(record.unprunedMs.median),
                        formatMilliseconds(record.nextPrunedMs.median),
                        formatMilliseconds(record.nextUnprunedMs.median));
  return text + (record.samePicture ? "" : " DIFFERS");
}

std::string stem(const std::string& file) {
  return std::filesystem::path(file).stem().string();
}

std::string matrixText(const std::vector<NeededCell>& cells) {
  // Columns have letters: the names of pipelines are longer than many cells.
  std::vector<std::string> pipelines;
  for (const NeededCell& cell : cells)
    if (std::find(pipelines.begin(), pipelines.end(), cell.pipeline) == pipelines.end())
      pipelines.push_back(cell.pipeline);
  const auto letter = [](std::size_t index) {
    return (index >= 26 ? std::string(1, static_cast<char>('A' + index / 26 - 1)) : std::string()) +
           static_cast<char>('A' + index % 26);
  };
  std::vector<std::vector<std::string>> rows{{"Scene"}};
  std::string legend, remarks;
  for (std::size_t i = 0; i < pipelines.size(); ++i) {
    rows.front().push_back(letter(i));
    legend += letter(i) + ": " + stem(pipelines[i]) + "\n";
  }
  std::string scene;
  std::size_t absent = 0, same = 0;
  for (const NeededCell& cell : cells) {
    if (rows.size() == 1 || cell.scene != scene) rows.push_back({stem(cell.scene)});
    scene = cell.scene;
    rows.back().push_back(cellText(cell));
    absent += !cell.record;
    same += cell.record && cell.record->samePicture;
    if (!cell.absent.empty())
      remarks += fmt::format("{}: {}, {}: {}\n", cell.failed ? "failed" : "absent", stem(cell.scene),
                             stem(cell.pipeline), cell.absent);
    else if (!cell.unsuited.empty())
      remarks += fmt::format("{} does not suit {}: {}, which the scene does not have\n", stem(cell.pipeline),
                             stem(cell.scene), cell.unsuited);
  }
  const bool timed = std::any_of(cells.begin(), cells.end(), [](const NeededCell& cell) {
    return cell.record && cell.record->prunedMs.repeats > 0;
  });
  return textTable(rows) + legend + remarks +
         fmt::format(
             "passes kept/all, shader variants needed/compiled/possible, memory as it runs/with everything "
             "kept{}; same picture, bit for bit: {} of {}{}\n",
             timed ? ", first frame as it runs/with everything kept, later frames the same" : "", same,
             cells.size() - absent, absent == 0 ? "" : fmt::format("; {} absent", absent));
}

Json matrixJson(const std::vector<NeededCell>& cells) {
  Json list = Json::array();
  for (const NeededCell& cell : cells) {
    Json json = cell.record ? asJson(*cell.record)
                            : Json{{"scene", cell.scene},
                                   {"pipeline", cell.pipeline},
                                   {"absent", cell.absent},
                                   {"failed", cell.failed}};
    json["unsuited"] = cell.unsuited;
    list.push_back(std::move(json));
  }
  return {{"cells", list}};
}

/// Every committed scene, those of the stress battery last.
std::vector<std::filesystem::path> allScenes() {
  const auto folder = committedScenes();
  if (!folder)
    throw AbsentError(
        "explain --all: no project here: no folder scenes/pipelines in this folder or above, nor beside the "
        "program");
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& from : {*folder, *folder / "stress"}) {
    std::vector<std::filesystem::path> own;
    std::error_code failure;
    for (const auto& entry : std::filesystem::directory_iterator(from, failure))
      if (entry.path().extension() == ".scene") own.push_back(entry.path());
    std::sort(own.begin(), own.end());
    files.insert(files.end(), own.begin(), own.end());
  }
  return files;
}

int explain(const ExplainCommand& command, const GlobalOptions& global) {
  ReportOptions options;
  for (const std::filesystem::path& text : command.texts)
    (kindOfText(text) == TextKind::scene ? options.scenes : options.pipelines).push_back(text);
  const bool one = options.scenes.size() == 1 && options.pipelines.size() == 1 && !command.all;
  options.pipelines.insert(options.pipelines.end(), command.pipelines.begin(), command.pipelines.end());
  if (command.all && !options.scenes.empty())
    throw Error("explain: --all takes every committed scene; name none");
  if (command.all) options.scenes = allScenes();
  if (options.scenes.empty()) throw Error("explain: no scene; expected a scene's text, or --all");
  options.settings = command.run.settings;
  options.camera = command.run.camera;
  options.time = command.run.time;
  options.seed = command.run.seed;
  std::tie(options.width, options.height) = command.run.size();
  options.repeats = command.noTimes ? 0 : command.repeats;

  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  const std::vector<NeededCell> cells = measureNeeded(
      *device, techniques, options, [&](const std::filesystem::path& file) { return global.loadScene(file); },
      [&](std::size_t done, std::size_t total) {
        if (total > 1) logInformation("{} of {}", done, total);
      });
  if (one && !cells.front().record) throw Error(cells.front().absent);
  if (command.json)
    printJson(one ? asJson(*cells.front().record) : matrixJson(cells));
  else
    print(one ? asText(*cells.front().record) : matrixText(cells));
  const bool good = std::all_of(cells.begin(), cells.end(), [](const NeededCell& cell) {
    return cell.record ? cell.record->samePicture : !cell.failed;
  });
  return good ? kGood : kNotGood;
}

}  // namespace

void addExplainCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "explain", "lists what a run leaves out, why, and what that saves, measured");
  auto options = std::make_shared<ExplainCommand>();
  command->add_option(
      "TEXT", options->texts,
      "a scene and a pipeline: in full; several scenes or pipelines: as a matrix (no pipeline: "
      "every committed one)");
  command->add_option("--pipeline", options->pipelines, "further pipelines' texts, for a matrix");
  command->add_flag("--all", options->all, "every committed scene, as a matrix");
  command->add_flag("--no-times", options->noTimes,
                    "only what is left out and whether the picture is the same; much faster");
  options->run.addTo(*command);
  command->add_option("--repeats", options->repeats, "timed frames of each kind (default 5)")
      ->check(CLI::Range(1, 10000));
  command->add_flag("--json", options->json, "print JSON");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return explain(*options, global); });
}

}  // namespace lumivox::command
