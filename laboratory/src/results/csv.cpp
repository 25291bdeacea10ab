#include "lumivox/results/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "results/fields.h"

namespace lumivox {
namespace {

constexpr const char* kParameter = "parameter_";

/// The columns of a record, after the list of its fields. What CSV has besides stands before or after them.
struct Columns {
  CsvTable& table;
  const ReportPoint& point;

  template <class M>
  void operator()(const results::Field& field, const M& member) {
    if constexpr (std::same_as<M, RunIdentity>) results::fields(member, *this);
    if (!field.csv) return;
    if constexpr (std::same_as<M, TimingStatistics>) {
      table.add(std::string(field.name) + "_ms", member);
    } else if constexpr (std::same_as<M, std::vector<std::string>>) {
      table.add(std::string(field.name) + "_findings", std::uint64_t{member.size()});
    } else if constexpr (std::same_as<M, StressOutcome>) {
      table.add(field.name, name(member));
    } else if constexpr (requires { table.add(field.name, member); }) {
      if (field.name == std::string_view("framework_share")) addCosts();
      table.add(field.name, member);
      if (field.name == std::string_view("peak_bytes")) addVoxels();
    }
  }
  template <class Flag>
  void operator()(const results::Field& field, const results::Against<Flag>& against) {
    table.add(field.name, against.bias ? "bias" : "misses");
  }
  void addCosts() {
    const CostParts parts = costParts(point);
    table.add("once_ms", parts.onceMs);
    table.add("when_moving_ms", parts.movingMs);
    table.add("every_frame_ms", parts.everyFrameMs);
  }
  void addVoxels() {
    table.add("voxels", point.voxels ? point.voxels->output : std::string());
    table.add("voxels_not_judged", point.voxels ? point.voxels->whyNot : std::string());
    for (const auto& [name, value] : metricsOf(point.voxels)) table.add(name, value);
  }
};

/// Without an error its columns are empty.
void addRow(CsvTable& table, const StoredRun& run, const ComponentError* error) {
  table.beginRow();
  table.add("run", run.id == 0 ? std::string() : std::to_string(run.id));
  Columns columns{table, run.point};
  results::fields(run, columns);
  if (error != nullptr) {
    results::fields(*error, columns);
    for (const NamedMetric& metric : metricsOf(*error)) {
      table.add(metric.name, metric.measured);
      table.add(metric.name + "_of_nothing", metric.ofNothing);
    }
  }
  table.add("command", run.point.command);
  for (const auto& [name, value] : run.point.parameters) table.addParameter(name, value.text());
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
  const ComponentError none;
  addRow(table, {}, &none);  // the header of no runs
  table.clearRows();
  for (const StoredRun& run : runs) {
    if (run.point.errors.empty()) addRow(table, run, nullptr);
    for (const ComponentError& error : run.point.errors) addRow(table, run, &error);
  }
  return table.text();
}

std::string stressCellsCsv(const std::vector<StressCell>& cells) {
  CsvTable table;
  const ReportPoint none;
  const auto add = [&](const StressCell& cell) {
    table.beginRow();
    results::fields(cell, Columns{table, none});
  };
  add({});
  table.clearRows();
  for (const StressCell& cell : cells) add(cell);
  return table.text();
}

}  // namespace lumivox
