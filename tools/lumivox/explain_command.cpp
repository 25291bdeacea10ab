// explain: the passes and outputs that a run leaves out, with reasons and savings. For many scenes and
// pipelines: a matrix with a block for each scene.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "command.h"
#include "common/named_texts.h"
#include "common/outputs.h"
#include "common/reasons.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/needs.h"
#include "lumivox/experiment/pipeline_graph.h"
#include "lumivox/results/json.h"
#include "lumivox/results/text.h"

namespace lumivox::command {
namespace {

struct ExplainCommand {
  std::vector<std::filesystem::path> texts;      ///< scenes and pipelines, in any order
  std::vector<std::filesystem::path> pipelines;  ///< of --pipeline
  std::filesystem::path graph;                   ///< empty: none
  RunOptions run;
  int repeats = 5;
  bool all = false, noTimes = false, json = false;
};

std::string leftOutText(const std::vector<Reason>& reasons) {
  std::vector<std::vector<std::string>> rows{{"Why", "Level", "Left out", "Memory", "ms"}};
  for (const Reason& reason : reasons)
    rows.push_back({reason.why, name(reason.level), fmt::format("{}", fmt::join(reason.what, ", ")),
                    reason.bytes == 0 ? "" : formatBytes(reason.bytes),
                    reason.ms == 0.0 ? "" : formatMilliseconds(reason.ms)});
  return rows.size() > 1 ? textTable(rows) : std::string();
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

/// The summary, then the work left out by reason, then the passes.
std::string asText(const PruningRecord& record) {
  const Explanation& explanation = record.explanation;
  const bool timed = record.prunedMs.repeats > 0;
  const std::vector<Reason> reasons = reasonsOf(explanation);
  std::string text =
      fmt::format("{} of {} passes kept; variants: {} possible, {} compiled, {} needed\n",
                  explanation.passesKept, explanation.passesTotal, explanation.variantsPossible,
                  explanation.variantsCompiled, explanation.variantsNeeded);
  if (timed)
    text += fmt::format(
        "left out: {} of the time of a first frame, against the same with everything kept\n"
        "stands still: {} of the time of a first frame, which the next ones with a moving camera do not take\n",
        formatPercent(std::max(record.savedShare(), 0.0)),
        formatPercent(std::max(record.standingShare(), 0.0)));
  text += fmt::format("memory of the passes {} in place of {}; same image: {}\n",
                      formatBytes(record.prunedBytes), formatBytes(record.unprunedBytes),
                      record.sameImage ? painted(Paint::good, "yes") : painted(Paint::bad, "NO"));
  text += reasons.empty() ? std::string("nothing is left out\n")
                          : fmt::format("{} {} left out for {} {}\n", explanation.leftOut.size(),
                                        explanation.leftOut.size() == 1 ? "thing" : "things", reasons.size(),
                                        reasons.size() == 1 ? "reason" : "reasons");
  text = remarks(text);
  if (!reasons.empty()) text += "\n" + leftOutText(reasons);
  return timed ? text + "\n" + passText(record) : text;
}

/// "42.1/57.5 MiB", or "900.0 KiB/1.2 MiB" where the units differ.
std::string bytesText(std::uint64_t first, std::uint64_t second) {
  std::string a = formatBytes(first);
  const std::string b = formatBytes(second);
  if (const std::size_t unit = a.rfind(' '); a.substr(unit) == b.substr(b.rfind(' '))) a.erase(unit);
  return a + "/" + b;
}

/// Name; passes kept of all; variants needed, compiled and possible; memory with pruning and without. If
/// times were measured, also those of a first and of a later frame.
std::vector<std::string> cellRow(const NeededCell& cell) {
  const std::string name = "  " + stem(cell.pipeline);
  if (!cell.record) return {name, cell.failed ? "failed" : "absent"};
  const PruningRecord& record = *cell.record;
  const Explanation& explanation = record.explanation;
  std::vector<std::string> row{name, fmt::format("{}/{}", explanation.passesKept, explanation.passesTotal),
                               fmt::format("{}/{}/{}", explanation.variantsNeeded,
                                           explanation.variantsCompiled, explanation.variantsPossible),
                               bytesText(record.prunedBytes, record.unprunedBytes)};
  if (record.prunedMs.repeats > 0) {
    const auto both = [](const TimingStatistics& pruned, const TimingStatistics& unpruned) {
      return formatMilliseconds(pruned.median) + "/" + formatMilliseconds(unpruned.median);
    };
    row.push_back(both(record.prunedMs, record.unprunedMs));
    row.push_back(both(record.nextPrunedMs, record.nextUnprunedMs));
  }
  if (!record.sameImage) row.push_back(painted(Paint::bad, "DIFFERS"));
  return row;
}

/// A remark below the tables: why a cell is empty, or why the pipeline does not suit the scene.
std::string remark(const NeededCell& cell, bool wholeScene) {
  if (!cell.absent.empty())
    return remarks(fmt::format("{}: {}{}: {}", cell.failed ? "failed" : "absent", stem(cell.scene),
                               wholeScene ? "" : ", " + stem(cell.pipeline), cell.absent));
  if (cell.unsuited.empty()) return {};
  return remarks(fmt::format("{} does not suit {}: {}, which the scene does not have", stem(cell.pipeline),
                             stem(cell.scene), cell.unsuited));
}

/// A block for each scene, with a line for each pipeline.
std::string matrixText(const std::vector<NeededCell>& cells) {
  const bool timed = std::any_of(cells.begin(), cells.end(), [](const NeededCell& cell) {
    return cell.record && cell.record->prunedMs.repeats > 0;
  });
  std::vector<std::vector<std::string>> rows;
  std::string below;
  std::size_t absent = 0, same = 0;
  for (auto first = cells.begin(); first != cells.end();) {
    const auto end =
        std::find_if(first, cells.end(), [&](const NeededCell& cell) { return cell.scene != first->scene; });
    const bool none =
        std::all_of(first, end, [](const NeededCell& cell) { return !cell.failed && !cell.absent.empty(); });
    if (!rows.empty()) rows.push_back({""});
    rows.push_back({stem(first->scene)});
    if (none)
      rows.back().emplace_back("absent");
    else
      rows.back().insert(rows.back().end(), {"passes", "variants", "memory"});
    if (!none && timed) rows.back().insert(rows.back().end(), {"first ms", "later ms"});
    if (none) below += remark(*first, true);
    for (; first != end; ++first) {
      absent += !first->record;
      same += first->record && first->record->sameImage;
      if (none) continue;
      rows.push_back(cellRow(*first));
      below += remark(*first, false);
    }
  }
  // Long names are shortened so that all numbers fit.
  std::vector<std::size_t> widths;
  for (const std::vector<std::string>& row : rows)
    for (std::size_t c = 1; c < row.size(); ++c) {
      if (c > widths.size()) widths.push_back(0);
      widths[c - 1] = std::max(widths[c - 1], shownWidth(row[c]) + 2);
    }
  const auto columns = static_cast<std::size_t>(outputColumns());
  const std::size_t room =
      columns - std::min(3 * columns / 4, std::accumulate(widths.begin(), widths.end(), std::size_t{0}));
  for (std::vector<std::string>& row : rows) row.front() = cutTo(row.front(), room);
  return textTable(rows) + below +
         remarks(fmt::format(
             "passes: kept/all; shader variants: needed/compiled/possible; memory{}: as it runs/with everything "
             "kept; same image, bit for bit: {} of {}{}",
             timed ? ", first frame, later frames" : "", same, cells.size() - absent,
             absent == 0 ? "" : fmt::format("; {} absent", absent)));
}

Json matrixJson(const std::vector<NeededCell>& cells) {
  Json list = Json::array();
  for (const NeededCell& cell : cells) {
    Json json = cell.record ? toJson(*cell.record)
                            : Json{{"scene", cell.scene},
                                   {"pipeline", cell.pipeline},
                                   {"absent", cell.absent},
                                   {"failed", cell.failed}};
    json["unsuited"] = cell.unsuited;
    list.push_back(std::move(json));
  }
  return {{"cells", list}};
}

/// All committed scenes, those of the stress battery last.
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

/// The file of --graph, checked. Error if `dot`, which draws an .svg, is absent.
Outputs graphOutput(const ExplainCommand& command, const ReportOptions& options, bool one) {
  Outputs outputs;
  outputs.add("--graph", command.graph, {".svg", ".dot", ".gv"});
  if (command.graph.empty()) return outputs;
  if (!one) throw Error("--graph draws one pipeline on one scene; expected one scene and one pipeline");
  outputs.check({options.scenes.front(), options.pipelines.front()});
  try {
    if (command.graph.extension() == ".svg") dotProgram();
  } catch (const AbsentError& absent) {
    throw AbsentError(fmt::format("--graph: {}", absent.what()));
  }
  return outputs;
}

int explain(const ExplainCommand& command, const GlobalOptions& global) {
  ReportOptions options;
  for (const std::filesystem::path& text : command.texts)
    (kindOfText(text) == TextKind::scene ? options.scenes : options.pipelines).push_back(text);
  options.pipelines.insert(options.pipelines.end(), command.pipelines.begin(), command.pipelines.end());
  const bool one = options.scenes.size() == 1 && options.pipelines.size() == 1 && !command.all;
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
  const Outputs outputs = graphOutput(command, options, one);

  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  if (options.pipelines.empty() && !command.json)
    logInformation(
        "no pipeline is named: every committed one is rendered as it runs and with everything kept{}; name a pipeline for that one in full",
        command.noTimes ? "" : ", and timed (--no-times is much faster)");
  Progress progress("explain", 0, "cells");
  const std::vector<NeededCell> cells = measureNeeded(
      *device, techniques, options,
      [&](const std::filesystem::path& file) {
        Scene scene = global.loadScene(file);
        outputs.requireUnread();
        return scene;
      },
      [&](std::size_t done, std::size_t total) {
        if (total > 1) progress.show(done, total, std::numeric_limits<double>::quiet_NaN());
      });
  if (one && !cells.front().record) throw Error(cells.front().absent);
  if (!command.graph.empty()) {
    const Pipeline pipeline = Pipeline::load(options.pipelines.front());
    writeGraph(command.graph, graphText(pipeline, techniques, pipeline.settings(options.settings),
                                        cells.front().record->explanation, stem(cells.front().scene)));
  }
  if (command.json)
    printJson(one ? toJson(*cells.front().record) : matrixJson(cells));
  else
    print(one ? asText(*cells.front().record) : matrixText(cells));
  const bool good = std::all_of(cells.begin(), cells.end(), [](const NeededCell& cell) {
    return cell.record ? cell.record->sameImage : !cell.failed;
  });
  return good ? kGood : kNotGood;
}

}  // namespace

void addExplainCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "explain", "lists what a run leaves out, why, and what that saves, measured");
  auto options = std::make_shared<ExplainCommand>();
  takesNames(command->add_option(
                 "TEXT", options->texts,
                 "a scene and a pipeline: in full; several scenes or pipelines: as a matrix (no pipeline: "
                 "every committed one)"),
             NamedText::sceneOrPipeline);
  takesNames(addRepeatable(*command, "--pipeline", options->pipelines,
                           "a further pipeline's text or name, for a matrix; may be repeated"),
             NamedText::pipeline);
  command->add_flag("--all", options->all, "every committed scene, as a matrix");
  command->add_flag("--no-times", options->noTimes,
                    "only what is left out and whether the image is the same; much faster");
  command->add_option("--graph", options->graph,
                      "draws the pipeline, grey where it is left out: .svg (needs Graphviz), .dot or .gv");
  options->run.addTo(*command);
  command->add_option("--repeats", options->repeats, "timed frames of each kind (default 5)")
      ->check(CLI::Range(1, 10000));
  command->add_flag("--json", options->json, "print JSON");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return explain(*options, global); });
}

}  // namespace lumivox::command
