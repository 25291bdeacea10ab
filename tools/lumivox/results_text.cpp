#include "results_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "lumivox/base/file.h"
#include "lumivox/results/text.h"
#include "measure_options.h"

namespace lumivox::command {
namespace {

/// "1..2", or "3" alone.
std::string seedsText(const RunIdentity& identity) {
  return identity.seeds <= 1 ? fmt::format("{}", identity.seed)
                             : fmt::format("{}..{}", identity.seed,
                                           identity.seed + static_cast<unsigned>(identity.seeds) - 1);
}

std::string stateText(const ReportPoint& point) {
  if (!point.failure.empty()) return painted(Paint::bad, "failed: ") + point.failure;
  return point.healthFindings.empty() ? painted(Paint::good, "good")
                                      : fmt::format("{} findings", point.healthFindings.size());
}

/// One line per run: its pipeline with the parameters that differ between runs, time, error and state.
std::string shortRunsTable(const std::vector<StoredRun>& runs, const std::vector<const ReportPoint*>& points,
                           const std::string& output) {
  const std::vector<std::string> names = lineNames(points);
  std::vector<std::vector<std::string>> rows{{"Scene", "Run", "Pipeline", "Frame ms"}};
  if (!output.empty()) rows[0].push_back(errorHeading(output));
  rows[0].push_back("State");
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ReportPoint& point = *points[i];
    std::vector<std::string> row{stem(point.scene), std::to_string(runs[i].id), names[i],
                                 point.frameMs.repeats == 0 ? "-" : formatMilliseconds(point.frameMs.median)};
    if (!output.empty()) row.push_back(errorText(errorOf(point, output, output != kWholeImage)));
    row.push_back(stateText(point));
    rows.push_back(std::move(row));
  }
  return groupedTable(rows, 2) + remarks(kErrorNote);
}

}  // namespace

std::string runsTable(const std::vector<StoredRun>& runs) {
  std::vector<const ReportPoint*> points;
  for (const StoredRun& run : runs) points.push_back(&run.point);
  const std::vector<std::string> outputs = judgedOutputs(points);
  if (outputColumns() < kWideColumns)
    return shortRunsTable(runs, points, outputs.empty() ? std::string() : outputs.back());
  std::vector<std::vector<std::string>> rows{
      {"Scene", "Run", "Pipeline", "Parameters", "Seeds", "Size", "Frame ms", "Memory"}};
  for (const std::string& output : outputs) rows[0].push_back(errorHeading(output));
  rows[0].push_back("State");
  for (const StoredRun& run : runs) {
    const ReportPoint& point = run.point;
    std::vector<std::string> row{stem(point.scene),
                                 std::to_string(run.id),
                                 stem(point.pipeline),
                                 parametersText(run.identity.parameters),
                                 seedsText(run.identity),
                                 fmt::format("{}x{}", run.identity.width, run.identity.height),
                                 quartilesText(point.frameMs),
                                 formatBytes(point.peakBytes)};
    for (const std::string& output : outputs)
      row.push_back(errorText(errorOf(point, output, output != kWholeImage)));
    row.push_back(stateText(point));
    rows.push_back(std::move(row));
  }
  return groupedTable(rows, 3) + remarks(kErrorNote);
}

}  // namespace lumivox::command
