#include "results_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "command.h"
#include "lumivox/base/file.h"
#include "lumivox/results/json.h"
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

Json timeJson(const TimingStatistics& time) {
  return {{"median_ms", jsonNumber(time.median)},
          {"lower_quartile_ms", jsonNumber(time.lowerQuartile)},
          {"upper_quartile_ms", jsonNumber(time.upperQuartile)},
          {"smallest_ms", jsonNumber(time.smallest)},
          {"largest_ms", jsonNumber(time.largest)},
          {"repeats", time.repeats}};
}

Json errorJson(const ComponentError& error) {
  Json metrics;
  for (const NamedMetric& metric : metricsOf(error))
    metrics[metric.name] = {{"value", jsonNumber(metric.measured.value)},
                            {"uncertainty", jsonNumber(metric.measured.uncertainty)},
                            {"of_nothing", jsonNumber(metric.ofNothing)}};
  return {{"output", error.output},
          {"component", error.component},
          {"reference", error.reference},
          {"against", error.bias ? "bias" : "misses"},
          {"seeds", error.seeds},
          {"deterministic", error.deterministic},
          {"noise_rmse", jsonNumber(error.noiseRmse)},
          {"metrics", metrics}};
}

Json identityJson(const RunIdentity& identity) {
  return {{"scene_hash", identity.sceneHash},
          {"pipeline_hash", identity.pipelineHash},
          {"techniques", identity.techniques},
          {"framework", identity.framework},
          {"parameters", identity.parameters},
          {"camera", identity.camera},
          {"time", identity.time},
          {"width", identity.width},
          {"height", identity.height},
          {"seed", identity.seed},
          {"seeds", identity.seeds},
          {"repeats", identity.repeats},
          {"subpixels", identity.subpixels},
          {"reference_samples", identity.referenceSamples},
          {"flicker_pairs", identity.flickerPairs},
          {"kept", identity.kept},
          {"device", identity.device},
          {"driver", identity.driver},
          {"shader_input", identity.shaderInput},
          {"host", identity.host}};
}

std::string stateText(const ReportPoint& point) {
  if (!point.failure.empty()) return painted(Paint::bad, "failed: ") + point.failure;
  return point.healthFindings.empty() ? painted(Paint::good, "good")
                                      : fmt::format("{} findings", point.healthFindings.size());
}

}  // namespace

Json jsonNumber(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

namespace {

/// One line a run: its pipeline with the parameters that tell it from others, time, error and state.
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

Json runsJson(const std::vector<StoredRun>& runs) {
  Json list = Json::array();
  for (const StoredRun& run : runs) {
    const ReportPoint& point = run.point;
    Json passes = Json::array();
    for (const std::string& name : point.passOrder) {
      Json pass{{"name", name}};
      if (const auto time = point.passDeviceMs.find(name); time != point.passDeviceMs.end())
        pass["device"] = timeJson(time->second);
      if (const auto time = point.passHostMs.find(name); time != point.passHostMs.end())
        pass["host"] = timeJson(time->second);
      if (const auto bytes = point.passBytes.find(name); bytes != point.passBytes.end())
        pass["bytes"] = bytes->second;
      if (const auto work = point.passWork.find(name); work != point.passWork.end())
        pass["work"] = work->second;
      passes.push_back(std::move(pass));
    }
    Json errors = Json::array();
    for (const ComponentError& error : point.errors) errors.push_back(errorJson(error));
    list.push_back({{"run", run.id},
                    {"key", run.identity.key()},
                    {"created", run.created},
                    {"version", run.version},
                    {"scene", point.scene},
                    {"scene_name", run.sceneName},
                    {"pipeline", point.pipeline},
                    {"pipeline_name", run.pipelineName},
                    {"sweep", point.sweep},
                    {"default", run.isDefault},
                    {"identity", identityJson(run.identity)},
                    {"frame", timeJson(point.frameMs)},
                    {"next_frame", timeJson(point.nextFrameMs)},
                    {"still_frame", timeJson(point.stillFrameMs)},
                    {"moved_frame", timeJson(point.movedFrameMs)},
                    {"framework_share", jsonNumber(point.frameworkShare)},
                    {"peak_bytes", point.peakBytes},
                    {"passes", passes},
                    {"errors", errors},
                    {"voxels", toJson(point.voxels)},
                    {"health", point.healthFindings},
                    {"failure", point.failure},
                    {"command", point.command}});
  }
  return list;
}

}  // namespace lumivox::command
