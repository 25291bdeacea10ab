#include "lumivox/results/measured_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kTablesVersion = 1;

double rounded(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return std::round(value * unit) / unit;
}

Json columnJson(const MeasuredTable::Column& column) {
  Json json = {{"name", column.name},
               {"decimals", column.decimals},
               {"margin", column.margin},
               {"share", column.share}};
  if (column.ofTimes) json["of_times"] = true;
  return json;
}

MeasuredTable tableOf(const Json& json) {
  MeasuredTable table;
  table.name = json.at("table");
  table.test = json.at("test");
  table.device = json.at("device");
  table.date = json.at("date");
  table.seconds = json.at("seconds");
  for (const Json& column : json.at("columns"))
    table.columns.push_back({column.at("name"), column.at("decimals"), column.at("margin"),
                             column.at("share"), column.value("of_times", false)});
  for (const Json& row : json.at("rows")) {
    table.rows.push_back({row.at(0), {}});
    if (row.size() != table.columns.size() + 1)
      throw Error(fmt::format("row '{}' of {} has {} values; expected {}", table.rows.back().name, table.name,
                              row.size() - 1, table.columns.size()));
    for (std::size_t i = 1; i < row.size(); ++i)
      table.rows.back().values.push_back(row[i].is_null() ? std::numeric_limits<double>::quiet_NaN()
                                                          : row[i].get<double>());
  }
  return table;
}

const MeasuredTable::Row* rowNamed(const MeasuredTable& table, const std::string& name) {
  const auto row = std::find_if(table.rows.begin(), table.rows.end(),
                                [&](const MeasuredTable::Row& one) { return one.name == name; });
  return row == table.rows.end() ? nullptr : &*row;
}

/// Adds rows that the second table lacks.
void addMissing(std::vector<std::string>& found, const MeasuredTable& table, const MeasuredTable& other,
                const std::vector<std::string>& absent, const char* what) {
  for (const MeasuredTable::Row& row : table.rows) {
    const bool isAbsent = std::any_of(absent.begin(), absent.end(), [&](const std::string& beginning) {
      return row.name.rfind(beginning, 0) == 0;
    });
    if (!isAbsent && rowNamed(other, row.name) == nullptr)
      found.push_back(fmt::format("{}, '{}': {}", table.name, row.name, what));
  }
}

}  // namespace

std::vector<MeasuredTable> readMeasuredTables(const std::filesystem::path& file) {
  const std::string text = readFile(file);
  try {
    const Json json = Json::parse(text);
    if (json.at("version") != kTablesVersion)
      throw Error(fmt::format("version {}; expected {}", json.at("version").dump(), kTablesVersion));
    std::vector<MeasuredTable> tables;
    for (const Json& table : json.at("tables")) tables.push_back(tableOf(table));
    return tables;
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", file.string(), error.what()));
  } catch (const Json::exception& error) {
    throw Error(fmt::format("{}: these are no measured tables: {}", file.string(), error.what()));
  }
}

std::string measuredTablesAsJson(const std::vector<MeasuredTable>& tables) {
  std::string text = fmt::format("{{\"version\": {}, \"tables\": [", kTablesVersion);
  const char* between = "\n";
  for (const MeasuredTable& table : tables) {
    text += between;
    between = ",\n";
    text += fmt::format(
        " {{\"table\": {},\n  \"test\": {},\n  \"device\": {},\n  \"date\": {}, \"seconds\": {},\n",
        Json(table.name).dump(), Json(table.test).dump(), Json(table.device).dump(), Json(table.date).dump(),
        std::lround(std::ceil(table.seconds)));
    Json columns = Json::array();
    for (const MeasuredTable::Column& column : table.columns) columns.push_back(columnJson(column));
    text += "  \"columns\": " + columns.dump() + ",\n  \"rows\": [";
    const char* betweenRows = "\n   ";
    for (const MeasuredTable::Row& row : table.rows) {
      Json values = Json::array({row.name});
      for (std::size_t i = 0; i < row.values.size(); ++i)
        values.push_back(std::isfinite(row.values[i])
                             ? Json(rounded(row.values[i], table.columns.at(i).decimals))
                             : Json(nullptr));
      text += betweenRows + values.dump();
      betweenRows = ",\n   ";
    }
    text += "]}";
  }
  return text + "]}\n";
}

std::vector<std::string> differences(const MeasuredTable& kept, const MeasuredTable& measured,
                                     const std::vector<std::string>& absent) {
  std::vector<std::string> found;
  const auto sameName = [](const MeasuredTable::Column& a, const MeasuredTable::Column& b) {
    return a.name == b.name;
  };
  if (!std::equal(kept.columns.begin(), kept.columns.end(), measured.columns.begin(), measured.columns.end(),
                  sameName)) {
    found.push_back(kept.name + ": its columns are others than those that are kept");
    return found;
  }
  addMissing(found, kept, measured, absent, "this row is kept, but was not measured");
  addMissing(found, measured, kept, {}, "this row was measured, but is not kept");
  for (const MeasuredTable::Row& row : measured.rows) {
    const MeasuredTable::Row* before = rowNamed(kept, row.name);
    if (before == nullptr) continue;
    for (std::size_t i = 0; i < row.values.size(); ++i) {
      const MeasuredTable::Column& column = measured.columns[i];
      if (column.ofTimes && kept.device != measured.device) continue;
      const double now = row.values[i], was = before->values[i];
      const double allowed = column.margin + column.share * std::abs(was);
      // Kept values are rounded.
      const double rounding = 0.5 * std::pow(10.0, -column.decimals);
      const bool same = std::isnan(was) ? std::isnan(now) : std::abs(now - was) <= allowed + rounding;
      if (!same)
        found.push_back(fmt::format("{}, '{}', {}: {:.{}f}, kept {:.{}f}; they may differ by {:.{}g}",
                                    measured.name, row.name, column.name, now, column.decimals + 1, was,
                                    column.decimals, allowed, 3));
    }
  }
  return found;
}

}  // namespace lumivox
