#include "page/needs_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "lumivox/analysis/interpolation.h"
#include "lumivox/base/file.h"
#include "page/page_parts.h"

namespace lumivox::page {
namespace {

/// What leaving out saved of a time, where that is more than the spread of the repeats.
std::string savedMs(const TimingStatistics& pruned, const TimingStatistics& unpruned) {
  const Measured before = medianOf(unpruned), after = medianOf(pruned);
  if (!decidable(before, after))
    return fmt::format("undecided with fewer than {} repeats, of {} ms", kLeastRepeats,
                       formatMilliseconds(before.value));
  if (!differ(before, after, kSignificantTimeShare))
    return fmt::format("not measurable, of {} ms", formatMilliseconds(before.value));
  return fmt::format("{} of {} ms", formatMilliseconds(before.value - after.value),
                     formatMilliseconds(before.value));
}

std::string savedBytes(const PruningRecord& record) {
  const std::uint64_t saved =
      record.unprunedBytes > record.prunedBytes ? record.unprunedBytes - record.prunedBytes : 0;
  return fmt::format("{} of {}", formatBytes(saved), formatBytes(record.unprunedBytes));
}

std::string matrixCell(const PruningRecord& record) {
  const Explanation& explanation = record.explanation;
  std::string html = "<dl class=\"cell\">";
  const auto line = [&](const char* what, const std::string& value) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>", what, value);
  };
  line("passes", fmt::format("{} of {}", explanation.passesKept, explanation.passesTotal));
  line("variants", fmt::format("{} / {} / {}", explanation.variantsNeeded, explanation.variantsCompiled,
                               explanation.variantsPossible));
  line("memory left out", savedBytes(record));
  line("first frame saves", savedMs(record.prunedMs, record.unprunedMs));
  line("later ones save", savedMs(record.nextPrunedMs, record.nextUnprunedMs));
  line("same picture",
       record.samePicture ? "<span class=\"good\">yes</span>" : "<span class=\"bad\">NO</span>");
  return html + "</dl>";
}

std::string matrixCell(const AnalysedScene& scene, const std::string& pipeline) {
  for (const PruningRecord& record : scene.pruning)
    if (record.pipeline == pipeline) return matrixCell(record);
  for (const auto& [file, why] : scene.unsuited)
    if (file == pipeline) return "<span class=\"soft\">not run: " + escaped(why) + "</span>";
  for (const PointRecord& record : scene.points)
    if (record.point.pipeline == pipeline && !record.point.failure.empty())
      return "<span class=\"bad\">failed: " + escaped(record.point.failure) + "</span>";
  return "<span class=\"soft\">not measured</span>";
}

}  // namespace

std::string neededMatrix(const AnalysedReport& data) {
  std::vector<std::string> pipelines;
  const auto add = [&](const std::string& pipeline) {
    if (std::find(pipelines.begin(), pipelines.end(), pipeline) == pipelines.end())
      pipelines.push_back(pipeline);
  };
  for (const AnalysedScene& scene : data.analysed) {
    for (const PointRecord& record : scene.points) add(record.point.pipeline);
    for (const auto& [pipeline, why] : scene.unsuited) add(pipeline);
  }
  std::sort(pipelines.begin(), pipelines.end());
  std::vector<Table::Column> columns{{"Scene"}};
  for (const std::string& pipeline : pipelines) columns.push_back({escaped(shortName(pipeline)), "cell"});
  Table table(columns);
  for (const AnalysedScene& scene : data.analysed) {
    std::vector<std::string> row{escaped(scene.name.empty() ? scene.file : scene.name)};
    for (const std::string& pipeline : pipelines) row.push_back(matrixCell(scene, pipeline));
    table.row(row);
  }
  return "<h2 id=\"needed\">What was needed</h2>\n<p class=\"caption\">Each pipeline as it runs on each scene, "
         "beside the same with everything kept. Passes kept of all that the text has; shader variants needed / "
         "compiled / possible; memory and time that leaving out saves. A later frame follows another while the "
         "camera moves, and runs only what changed. Leaving out may change the cost, never the picture: both "
         "are compared bit for bit. Under each scene below: what was left out, and why.</p>\n" +
         table.html();
}

std::string neededSection(const AnalysedScene& scene) {
  std::string html =
      "<h3>What was left out, and what that saved</h3>\n<p class=\"caption\">The pipeline as it runs and the "
      "same with everything kept, timed "
      "alternately at the default parameters. Leaving out may change the cost, never the picture.</p>\n";
  for (const PruningRecord& record : scene.pruning) {
    const Explanation& explanation = record.explanation;
    html += "<h4>" + escaped(shortName(record.pipeline)) + "</h4>\n";
    html += fmt::format(
        "<p>{} ms instead of {} ms: <b>{}</b> of the time of a first frame saved; {} ms instead of {} ms: "
        "<b>{}</b> "
        "of that of a frame that follows another while the camera moves. {} of {} passes kept; shader "
        "variants: {} possible, {} "
        "compiled, {} needed. Memory taken by the passes: {} instead of {}. Same picture, bit for bit: "
        "{}.</p>\n",
        withQuartiles(record.prunedMs), withQuartiles(record.unprunedMs), percent(record.savedShare()),
        withQuartiles(record.nextPrunedMs), withQuartiles(record.nextUnprunedMs),
        percent(record.savedShareNext()), explanation.passesKept, explanation.passesTotal,
        explanation.variantsPossible, explanation.variantsCompiled, explanation.variantsNeeded,
        formatBytes(record.prunedBytes), formatBytes(record.unprunedBytes),
        record.samePicture ? "<span class=\"good\">yes</span>" : "<span class=\"bad\">NO</span>");
    if (!explanation.leftOut.empty()) {
      Table table(
          {{"Level"}, {"Left out"}, {"Why", "wide"}, {"Saved memory", "number"}, {"Saved ms", "number"}});
      for (const LeftOut& one : explanation.leftOut)
        table.row({name(one.level), escaped(one.what), escaped(one.why),
                   one.savedBytes == 0 ? "" : formatBytes(one.savedBytes),
                   one.savedMs == 0.0 ? "" : number(one.savedMs)});
      html += table.html();
    }
    Table passes(
        {{"Pass"}, {"as it runs, ms", "number"}, {"everything kept, ms", "number"}, {"saved, ms", "number"}});
    for (const std::string& pass : record.passOrder) {
      const auto pruned = record.prunedPassMs.find(pass), unpruned = record.unprunedPassMs.find(pass);
      const double before = unpruned == record.unprunedPassMs.end() ? 0.0 : unpruned->second.median;
      const double after = pruned == record.prunedPassMs.end() ? 0.0 : pruned->second.median;
      passes.row({escaped(pass),
                  pruned == record.prunedPassMs.end() ? "left out" : withQuartiles(pruned->second),
                  unpruned == record.unprunedPassMs.end() ? "-" : withQuartiles(unpruned->second),
                  number(before - after)});
    }
    html += "<details><summary>Pass by pass</summary>\n" + passes.html() + "</details>\n";
  }
  if (!scene.unsuited.empty()) {
    html += "<p>Committed pipelines that do not suit this scene:</p>\n<ul>\n";
    for (const auto& [pipeline, why] : scene.unsuited)
      html += "<li>" + escaped(shortName(pipeline)) + ": " + escaped(why) + "</li>\n";
    html += "</ul>\n";
  }
  return html;
}

}  // namespace lumivox::page
