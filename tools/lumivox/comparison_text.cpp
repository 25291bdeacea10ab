#include "comparison_text.h"

#include <fmt/format.h>

#include <filesystem>

#include "lumivox/results/text.h"
#include "measure_options.h"

namespace lumivox::command {
namespace {

std::string nameOf(const PipelineComparison& comparison, std::size_t pipeline) {
  return std::filesystem::path(comparison.pipelines[pipeline].pipeline).stem().string();
}

std::string parametersOf(const ComparedPoint& point) {
  std::map<std::string, std::string> parameters;
  for (const auto& [name, value] : point.parameters) parameters[name] = value.text();
  return parametersText(parameters);
}

std::string measuredText(const Measured& measured) {
  return fmt::format("{} ± {:.1g}", threeDigits(measured.value), measured.uncertainty);
}

std::string timeText(const Measured& timeMs) {
  return formatMilliseconds(timeMs.value) + " ± " + formatMilliseconds(timeMs.uncertainty);
}

/// One line per point: its pipeline with the parameters that differ between points, and the number of a point
/// that beats it.
std::string shortFrontTable(const PipelineComparison& comparison) {
  std::vector<ReportPoint> records(comparison.points.size());
  std::vector<const ReportPoint*> points;
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].pipeline = comparison.pipelines[comparison.points[i].pipeline].pipeline;
    records[i].parameters = comparison.points[i].parameters;
    points.push_back(&records[i]);
  }
  const std::vector<std::string> names = lineNames(points);
  std::vector<std::vector<std::string>> rows{{"Point", "Pipeline", "Frame ms", comparison.metric, ""}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ComparedPoint& point = comparison.points[i];
    const bool undecided = !point.tradeOff.timeMs.enoughRepeats || !point.tradeOff.error.enoughRepeats;
    rows.push_back({std::to_string(i + 1), names[i], formatMilliseconds(point.frameMs.median),
                    measuredText(point.tradeOff.error),
                    point.beatenBy ? fmt::format("beaten by {}", *point.beatenBy + 1)
                    : undecided    ? "undecided"
                                   : "on the front"});
  }
  return textTable(rows, 2);
}

std::string frontTable(const PipelineComparison& comparison) {
  if (outputColumns() < kWideColumns) return shortFrontTable(comparison);
  std::vector<std::vector<std::string>> rows{{"Pipeline", "Parameters", "Frame ms", comparison.metric, ""}};
  for (const ComparedPoint& point : comparison.points) {
    std::string standing = "on the Pareto front";
    if (!point.tradeOff.timeMs.enoughRepeats || !point.tradeOff.error.enoughRepeats)
      standing += ", undecided";
    if (point.beatenBy) {
      const ComparedPoint& by = comparison.points[*point.beatenBy];
      standing = fmt::format("beaten by {} {}", nameOf(comparison, by.pipeline), parametersOf(by));
    }
    rows.push_back({nameOf(comparison, point.pipeline), parametersOf(point), quartilesText(point.frameMs),
                    measuredText(point.tradeOff.error), standing});
  }
  return textTable(rows, 2);
}

std::string frontText(const PipelineComparison& comparison) {
  std::string text = frontTable(comparison);
  for (const FrameTimeRange& range : comparison.ranges) {
    text += fmt::format("from {} ms{}: ", formatMilliseconds(range.fromMs),
                        range.toMs ? fmt::format(" to {} ms", formatMilliseconds(*range.toMs)) : " on");
    for (std::size_t i = 0; i < range.best.size(); ++i)
      text += (i == 0   ? ""
               : i == 1 ? "; not told apart from it: "
                        : ", ") +
              nameOf(comparison, comparison.points[range.best[i]].pipeline);
    text += "\n";
  }
  return text;
}

std::string equalText(const PipelineComparison& comparison, const std::vector<double>& limits,
                      const char* unit, const char* notReached, std::string (*text)(const Measured&),
                      std::vector<ComparedCell> ComparedPipeline::*cells) {
  std::vector<std::vector<std::string>> rows{{"Pipeline"}};
  for (const double limit : limits) rows.front().push_back(fmt::format("{:.4g}{}", limit, unit));
  for (std::size_t pipeline = 0; pipeline < comparison.pipelines.size(); ++pipeline) {
    rows.push_back({nameOf(comparison, pipeline)});
    for (const ComparedCell& cell : comparison.pipelines[pipeline].*cells) {
      const Interpolated& reached = cell.reached;
      rows.back().push_back(reached.reach == Reach::notMeasured ? "-"
                            : reached.reach == Reach::notReached
                                ? notReached
                                : (reached.reach == Reach::atMost ? "<= " : "") + text(reached.value) +
                                      (cell.best ? " *" : ""));
    }
  }
  return textTable(rows) +
         "* the least, and what cannot be told apart from it; <=: no less was measured; interpolated between "
         "measured points, never beyond them\n";
}

/// The conditions of the comparison: when times count as different, and which points decide nothing.
std::string basisText(const PipelineComparison& comparison) {
  std::string text =
      fmt::format("times count as different beyond {:.1f} %{}\n", 100.0 * comparison.timeShare,
                  comparison.controls == 0 ? ", no point was timed twice here"
                                           : fmt::format(" ({} points timed twice)", comparison.controls));
  for (const auto& [pipeline, as] : comparison.same)
    text +=
        fmt::format("{} comes to the same passes as {} in this scene\n", shortName(pipeline), shortName(as));
  if (comparison.equalForAll)
    text += "all pipelines have a point with the same error, to the bit: this light tells nothing apart\n";
  if (comparison.undecided > 0)
    text += fmt::format(
        "{} of {} points have fewer than {} timed frames or seeds: whether they are better is undecided\n",
        comparison.undecided, comparison.points.size(), kLeastRepeats);
  return text;
}

std::string tableText(const PipelineComparison& comparison, ComparisonTable table);

}  // namespace

std::string comparisonText(const PipelineComparison& comparison, ComparisonTable table) {
  return tableText(comparison, table) + basisText(comparison);
}

namespace {

std::string tableText(const PipelineComparison& comparison, ComparisonTable table) {
  const std::string title = fmt::format(
      "{}, {} against {}\n", comparison.component == "final" ? "whole image" : comparison.component,
      comparison.metric, comparison.reference);
  switch (table) {
    case ComparisonTable::front:
      return title + frontText(comparison);
    case ComparisonTable::equalTime:
      return title + equalText(comparison, comparison.frameTimesMs, " ms", "slower", measuredText,
                               &ComparedPipeline::atTime);
    case ComparisonTable::equalError:
      break;
  }
  if (comparison.errors.empty())
    return title + "all errors are the same within 0.5 %: there is nothing to interpolate between\n";
  return title +
         equalText(comparison, comparison.errors, "", "not reached", timeText, &ComparedPipeline::atError) +
         "times in ms\n";
}

}  // namespace

}  // namespace lumivox::command
