#include "lumivox/results/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "results/field_json.h"

namespace lumivox {
namespace {

using results::Json;
using results::jsonOf;

/// A field of a row, quoted if necessary.
std::string fieldText(const Json& value) {
  if (value.is_null()) return {};
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (value.is_array()) return std::to_string(value.size());
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  if (!value.is_string()) return value.dump();
  const std::string text = value.get<std::string>();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// Rows of the record fields that have CSV columns. Columns are in order of first appearance, followed by
/// parameters by name. A row without a column's value has an empty field.
class Rows {
 public:
  void begin() { rows_.emplace_back(); }
  /// The error of the run to write, if any.
  template <class T>
  void add(const T& record, const ComponentError* error = nullptr) {
    results::fields(record, [&]<class M>(const results::Field& field, const M& member) {
      if constexpr (std::same_as<M, std::vector<ComponentError>>) {
        if (error != nullptr) add(*error);
      } else if constexpr (std::same_as<M, std::optional<GatheredVoxels>>) {
        if (member) add(*member);
      } else if constexpr (std::same_as<M, results::Metrics<const T>>) {
        for (const NamedMetric& metric : metricsOf(record)) put(metric.name, jsonOf(metric));
      } else if (field.csv != nullptr && field.name == std::string_view("parameters")) {
        const Json parameters = jsonOf(member);
        for (const auto& [name, value] : parameters.items()) putParameter(name, value);
      } else if (field.csv != nullptr) {
        put(*field.csv == '\0' ? field.name : field.csv, jsonOf(member));
      }
    });
  }
  /// Puts COLUMN and, for values with uncertainty or quartiles, COLUMN_uncertainty, COLUMN_lower_quartile,
  /// ...
  void put(const std::string& column, const Json& value) {
    if (!value.is_object()) {
      if (std::find(columns_.begin(), columns_.end(), column) == columns_.end()) columns_.push_back(column);
      rows_.back()[column] = fieldText(value);
      return;
    }
    const bool isTimed = value.value("repeats", 1) > 0;
    for (const auto& [name, part] : value.items())
      if (name == "value" || name == "median")
        put(column, isTimed ? part : Json());
      else if (name == "uncertainty")
        put(column + "_uncertainty", value.at("value").is_null() ? Json() : part);
      else if (name == "of_nothing" || name.ends_with("_quartile"))
        put(column + "_" + name, isTimed ? part : Json());
  }
  /// Removes the rows and keeps the columns as the header of an empty table.
  void clear() { rows_.clear(); }
  /// Lines end in CR LF, as RFC 4180 has it.
  std::string text() const {
    std::vector<std::string> all = columns_;
    all.insert(all.end(), parameters_.begin(), parameters_.end());
    std::string text;
    for (const std::string& column : all) text += (text.empty() ? "" : ",") + fieldText(column);
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

 private:
  void putParameter(const std::string& name, const Json& value) {
    rows_.back()[*parameters_.insert("parameter_" + name).first] = fieldText(value);
  }

  std::vector<std::string> columns_;
  std::set<std::string> parameters_;
  std::vector<std::map<std::string, std::string>> rows_;
};

void addRun(Rows& rows, const StoredRun& run, const ComponentError* error) {
  rows.begin();
  rows.put("run", run.id == 0 ? Json() : Json(run.id));
  rows.add(run, error);
}

}  // namespace

std::string runsCsv(const std::vector<StoredRun>& runs) {
  Rows rows;
  const ComponentError none;
  StoredRun whole;
  whole.point.voxels.emplace();
  addRun(rows, whole, &none);  // the header of no runs
  rows.clear();
  for (const StoredRun& run : runs) {
    if (run.point.errors.empty()) addRun(rows, run, nullptr);
    for (const ComponentError& error : run.point.errors) addRun(rows, run, &error);
  }
  return rows.text();
}

std::string stressCellsCsv(const std::vector<StressCell>& cells) {
  Rows rows;
  rows.begin();
  rows.add(StressCell());  // the header of no cells
  rows.clear();
  for (const StressCell& cell : cells) {
    rows.begin();
    rows.add(cell);
  }
  return rows.text();
}

std::string voxelizersCsv(const std::vector<VoxelizerRecord>& records, const gpu::DeviceInfo& device) {
  Rows rows;
  for (const VoxelizerRecord& record : records) {
    rows.begin();
    rows.put("device", device.renderer);
    rows.put("driver", device.version);
    rows.add(record);
  }
  return rows.text();
}

}  // namespace lumivox
