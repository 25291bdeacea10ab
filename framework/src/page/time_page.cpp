// Passes, their time and memory, and their distance from the ceilings of the device.
#include "page/time_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/file.h"
#include "page/page_parts.h"

namespace lumivox::page {
namespace {

/// Points of one pipeline that were measured, and the passes of any of them in the order of running.
struct PipelinePoints {
  std::vector<const PointRecord*> points;
  std::vector<std::string> passes;
};

PipelinePoints pointsOf(const AnalysedScene& scene, const std::string& pipeline) {
  PipelinePoints result;
  for (const PointRecord& record : scene.points) {
    if (record.point.pipeline != pipeline || !record.point.failure.empty()) continue;
    result.points.push_back(&record);
    for (const std::string& pass : record.point.passOrder)
      if (std::find(result.passes.begin(), result.passes.end(), pass) == result.passes.end())
        result.passes.push_back(pass);
  }
  return result;
}

std::string passTable(const PipelinePoints& pipeline) {
  std::vector<Table::Column> columns{{"Pass"}};
  for (const PointRecord* record : pipeline.points)
    columns.push_back({escaped(parametersText(record->point.parameters)) + ": ms", "number"});
  for (const PointRecord* record : pipeline.points)
    columns.push_back({escaped(parametersText(record->point.parameters)) + ": memory", "number"});
  Table table(columns);
  const auto row = [&](const std::string& title, const auto& time, const auto& memory,
                       const char* kind = "") {
    std::vector<std::string> cells{title};
    for (const PointRecord* record : pipeline.points) cells.push_back(time(record->point));
    for (const PointRecord* record : pipeline.points) cells.push_back(memory(record->point));
    table.row(cells, kind);
  };
  const auto nothing = [](const ReportPoint&) { return std::string(); };
  for (const std::string& pass : pipeline.passes)
    row(
        escaped(pass),
        [&](const ReportPoint& point) {
          const auto found = point.passDeviceMs.find(pass);
          return found == point.passDeviceMs.end() ? std::string("-") : withQuartiles(found->second);
        },
        [&](const ReportPoint& point) {
          const auto found = point.passBytes.find(pass);
          return found == point.passBytes.end() ? std::string("-") : formatBytes(found->second);
        });
  row(
      "whole frame; most memory at once",
      [](const ReportPoint& point) { return withQuartiles(point.frameMs); },
      [](const ReportPoint& point) { return formatBytes(point.peakBytes); }, "total");
  row(
      "between passes (the framework)",
      [](const ReportPoint& point) { return percent(point.frameworkShare); }, nothing);
  row(
      "next frame, only what changed",
      [](const ReportPoint& point) { return withQuartiles(point.nextFrameMs); }, nothing);
  return table.html();
}

double millisecondsOf(const ReportPoint& point, const std::string& pass) {
  const auto time = point.passDeviceMs.find(pass);
  return time == point.passDeviceMs.end() ? 0.0 : time->second.median;
}

double sumOf(const std::vector<WorkBound>& bounds) {
  double sum = 0.0;
  for (const WorkBound& bound : bounds) sum += bound.ms;
  return sum;
}

/// The operations that there are most of: "12.3 M texture samples d3 rgba16f mips; 4.56 M buffer reads".
std::string workText(const Work& work) {
  std::vector<std::pair<double, std::string>> counts;
  for (const auto& [name, count] : work)
    if (count > 0.0) counts.emplace_back(count, name);
  std::sort(counts.rbegin(), counts.rend());
  std::string text;
  constexpr std::size_t kShown = 6;
  for (std::size_t i = 0; i < std::min(counts.size(), kShown); ++i)
    text +=
        (i == 0 ? "" : "; ") + formatThousands(counts[i].first) + " " + replaced(counts[i].second, "_", " ");
  return text;
}

std::string limitTable(const ReportPoint& point) {
  Table table({{"Pass"},
               {"ms", "number"},
               {"Share of the frame", "number"},
               {"Limited by"},
               {"At least, ms", "number"},
               {"Of the ceiling", "number"},
               {"One after the other", "number"},
               {"Does", "wide"}});
  for (const std::string& pass : point.passOrder) {
    const auto work = point.passWork.find(pass);
    const auto bounds = point.passBounds.find(pass);
    const double ms = millisecondsOf(point, pass);
    const bool bounded = bounds != point.passBounds.end() && !bounds->second.empty() && ms > 0.0;
    table.row(
        {escaped(pass), number(ms), point.frameMs.median > 0.0 ? percent(ms / point.frameMs.median) : "-",
         bounded ? bounds->second.front().resource : "-", bounded ? number(bounds->second.front().ms) : "-",
         bounded ? percent(bounds->second.front().ms / ms) : "-",
         bounded ? percent(sumOf(bounds->second) / ms) : "-",
         work == point.passWork.end() ? "" : escaped(workText(work->second))});
  }
  return table.html();
}

}  // namespace

std::string timeSection(std::size_t sceneIndex, const AnalysedScene& scene) {
  const std::size_t bars = scene.points.size();
  std::string html =
      "<h3>Time and memory per pass</h3>\n<p class=\"caption\">Medians over repeats of frames in which every "
      "kept pass "
      "runs; quartiles in brackets. Measured apart from the pictures above. What a pass does was counted in a "
      "frame of its own; with the ceilings of this device it gives the time that the pass takes at least: on "
      "the resource that limits it, and on all of them one after the other, as a device that overlaps nothing "
      "would need.</p>\n<div class=\"charts\">\n";
  for (const char* chart : {"time", "bytes"})
    html += fmt::format(
        "<figure><div class=\"chart\" style=\"height:{}px\"><canvas data-chart=\"{}\" "
        "data-scene=\"{}\"></canvas></div></figure>\n",
        140 + 48 * bars, chart, sceneIndex);
  html += "</div>\n";

  std::vector<std::string> pipelines;
  for (const PointRecord& record : scene.points)
    if (std::find(pipelines.begin(), pipelines.end(), record.point.pipeline) == pipelines.end())
      pipelines.push_back(record.point.pipeline);
  for (const std::string& pipeline : pipelines) {
    const PipelinePoints measured = pointsOf(scene, pipeline);
    if (measured.points.empty()) continue;
    html += "<h4>" + escaped(shortName(pipeline)) + "</h4>\n" + passTable(measured);
    std::string more;
    for (const PointRecord* record : measured.points) {
      const ReportPoint& point = record->point;
      if (!point.whyNotCounted.empty()) {
        html += "<p>What the passes do was not counted: " + escaped(point.whyNotCounted) + ".</p>\n";
        break;
      }
      if (record->isDefault)
        html += "<p>How far from the limit, at the default parameters:</p>\n" + limitTable(point);
      else
        more += "<h4>" + escaped(parametersText(point.parameters)) + "</h4>\n" + limitTable(point);
    }
    if (!more.empty())
      html +=
          "<details><summary>How far from the limit at the other points</summary>\n" + more + "</details>\n";
  }
  return html;
}

std::string ceilingSection(const std::vector<DeviceCeiling>& ceilings) {
  if (ceilings.empty())
    return "<p>What this device can do at most is not known: <code>lumivox device</code> measures it, once, and "
           "the next report says how far each pass is from it.</p>\n";
  Table table({{"What"}, {"At most", "number"}, {"Quartiles", "number"}, {"Unit"}, {"Measured"}});
  for (const DeviceCeiling& ceiling : ceilings)
    table.row(
        {escaped(replaced(ceiling.name, "_", " ")), formatThousands(ceiling.rate.median),
         formatThousands(ceiling.rate.lowerQuartile) + " .. " + formatThousands(ceiling.rate.upperQuartile),
         escaped(ceiling.unit), escaped(ceiling.created)});
  return "<details><summary>What this device can do at most</summary>\n" + table.html() + "</details>\n";
}

}  // namespace lumivox::page
