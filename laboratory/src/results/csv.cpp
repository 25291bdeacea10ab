#include "lumivox/results/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lumivox {
namespace {

constexpr const char* kParameter = "parameter_";

void addRow(CsvTable& table, const StoredRun& run, const ComponentError& error) {
  const ReportPoint& point = run.point;
  const RunIdentity& identity = run.identity;
  table.beginRow();
  table.add("run", run.id == 0 ? std::string() : std::to_string(run.id));
  table.add("created", run.created);
  table.add("scene", point.scene);
  table.add("pipeline", point.pipeline);
  table.add("sweep", point.sweep);
  table.add("default", run.isDefault);
  table.add("camera", identity.camera);
  table.add("time", identity.time);
  table.add("width", identity.width);
  table.add("height", identity.height);
  table.add("seed", std::uint64_t{identity.seed});
  table.add("seeds", error.output.empty() ? identity.seeds : error.seeds);
  table.add("repeats", identity.repeats);
  table.add("subpixels", identity.subpixels);
  table.add("reference_samples", identity.referenceSamples);
  table.add("device", identity.device);
  table.add("driver", identity.driver);
  table.add("shader_input", identity.shaderInput);
  table.add("host", identity.host);
  table.add("frame_ms", point.frameMs);
  table.add("next_frame_ms", point.nextFrameMs);
  const CostParts parts = costParts(point);
  table.add("once_ms", parts.onceMs);
  table.add("when_moving_ms", parts.movingMs);
  table.add("every_frame_ms", parts.everyFrameMs);
  table.add("framework_share", point.frameworkShare);
  table.add("peak_bytes", std::uint64_t{point.peakBytes});
  table.add("voxels", point.voxels ? point.voxels->output : std::string());
  table.add("voxels_not_judged", point.voxels ? point.voxels->whyNot : std::string());
  for (const auto& [name, value] : metricsOf(point.voxels)) table.add(name, value);
  table.add("health_findings", std::uint64_t{point.healthFindings.size()});
  table.add("failure", point.failure);
  table.add("output", error.output);
  table.add("component", error.component);
  table.add("reference", error.reference);
  table.add("against", error.output.empty() ? "" : error.bias ? "bias" : "misses");
  table.add("deterministic", error.output.empty() ? std::string() : error.deterministic ? "1" : "0");
  for (const NamedMetric& metric : metricsOf(error)) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const bool is = !error.output.empty();
    table.add(metric.name, is ? metric.measured : Measured{kNone, kNone});
    table.add(std::string(metric.name) + "_of_nothing", is ? metric.ofNothing : kNone);
  }
  table.add("command", point.command);
  for (const auto& [name, value] : point.parameters) table.addParameter(name, value.text());
}

}  // namespace

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

void CsvTable::put(const std::string& column, std::string field) {
  rows_.back()[column] = std::move(field);
}

void CsvTable::add(const std::string& column, const std::string& value) {
  if (std::find(columns_.begin(), columns_.end(), column) == columns_.end()) columns_.push_back(column);
  put(column, csvField(value));
}

void CsvTable::add(const std::string& column, double value) {
  add(column, std::isfinite(value) ? fmt::format("{}", value) : std::string());
}

void CsvTable::add(const std::string& column, std::uint64_t value) {
  add(column, fmt::format("{}", value));
}

void CsvTable::add(const std::string& column, int value) {
  add(column, fmt::format("{}", value));
}

void CsvTable::add(const std::string& column, bool value) {
  add(column, value ? "1" : "0");
}

void CsvTable::add(const std::string& column, const Measured& value) {
  add(column, value.value);
  add(column + "_uncertainty", std::isnan(value.value) ? value.value : value.uncertainty);
}

void CsvTable::add(const std::string& column, const TimingStatistics& time) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool is = time.repeats > 0;
  add(column, is ? time.median : kNone);
  add(column + "_lower_quartile", is ? time.lowerQuartile : kNone);
  add(column + "_upper_quartile", is ? time.upperQuartile : kNone);
}

void CsvTable::addParameter(const std::string& name, const std::string& value) {
  parameters_.insert(name);
  put(kParameter + name, csvField(value));
}

std::string CsvTable::text() const {
  std::vector<std::string> all = columns_;
  for (const std::string& name : parameters_) all.push_back(kParameter + name);
  std::string text;
  for (const std::string& column : all) text += (text.empty() ? "" : ",") + csvField(column);
  text += "\r\n";
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto field = row.find(all[i]);
      text += (i == 0 ? "" : ",") + (field == row.end() ? std::string() : field->second);
    }
    text += "\r\n";
  }
  return text;
}

std::string runsCsv(const std::vector<StoredRun>& runs) {
  CsvTable table;
  addRow(table, {}, {});  // the header of no runs
  table.clearRows();
  for (const StoredRun& run : runs) {
    if (run.point.errors.empty()) addRow(table, run, {});
    for (const ComponentError& error : run.point.errors) addRow(table, run, error);
  }
  return table.text();
}

}  // namespace lumivox
