// The figures of slow tests that a paper card quotes, written from the kept tables.
#include "lumivox/page/measured_passages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lumivox/base/error.h"
#include "page/markup.h"
#include "page/passages.h"

namespace lumivox {
namespace {

std::string cell(double value, const MeasuredTable::Column& column) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, column.decimals) : std::string();
}

std::string row(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& one : cells)
    text += " " + page::replaced(one, "|", "\\|") + (one.empty() ? "|" : " |");
  return text + "\n";
}

std::string table(const MeasuredTable& measured, const std::vector<std::string>& beginnings) {
  std::vector<std::string> heads{""};
  for (const MeasuredTable::Column& column : measured.columns) heads.push_back(column.name);
  std::string text = "\n\n" + row(heads) + row(std::vector<std::string>(heads.size(), "---"));
  std::vector<bool> used(beginnings.size(), false);
  for (const MeasuredTable::Row& one : measured.rows) {
    bool wanted = beginnings.empty();
    for (std::size_t i = 0; i < beginnings.size(); ++i)
      if (one.name.rfind(beginnings[i], 0) == 0) wanted = used[i] = true;
    if (!wanted) continue;
    std::vector<std::string> cells{one.name};
    for (std::size_t i = 0; i < one.values.size(); ++i)
      cells.push_back(cell(one.values[i], measured.columns[i]));
    text += row(cells);
  }
  for (std::size_t i = 0; i < beginnings.size(); ++i)
    if (!used[i]) throw Error(fmt::format("no row of {} begins with '{}'", measured.name, beginnings[i]));
  return text + "\n";
}

/// Rows called "SCENE, REST": a line for each REST, and the values of each SCENE in a column.
std::string across(const MeasuredTable& measured, const std::vector<std::string>& beginnings) {
  std::vector<std::string> heads{""}, rests;
  std::string names;
  for (const MeasuredTable::Column& column : measured.columns)
    names += (names.empty() ? "" : ", ") + column.name;
  std::map<std::pair<std::string, std::string>, std::string> cells;
  for (const std::string& beginning : beginnings) {
    heads.push_back(beginning + ": " + names);
    bool used = false;
    for (const MeasuredTable::Row& one : measured.rows) {
      if (one.name.rfind(beginning + ", ", 0) != 0) continue;
      used = true;
      const std::string rest = one.name.substr(beginning.size() + 2);
      if (std::find(rests.begin(), rests.end(), rest) == rests.end()) rests.push_back(rest);
      std::string& text = cells[{rest, beginning}];
      for (std::size_t i = 0; i < one.values.size(); ++i)
        if (std::isfinite(one.values[i]))
          text += (text.empty() ? "" : ", ") + cell(one.values[i], measured.columns[i]);
    }
    if (!used) throw Error(fmt::format("no row of {} begins with '{}, '", measured.name, beginning));
  }
  std::string text = "\n\n" + row(heads) + row(std::vector<std::string>(heads.size(), "---"));
  for (const std::string& rest : rests) {
    std::vector<std::string> line{rest};
    for (const std::string& beginning : beginnings) line.push_back(cells[{rest, beginning}]);
    text += row(line);
  }
  return text + "\n";
}

/// The columns that a name "of COLUMN, COLUMN" chooses, which is taken from `names`; all without one.
MeasuredTable narrowed(const MeasuredTable& measured, std::vector<std::string>& names) {
  static const std::string kOf = "of ";
  const auto chosen = std::find_if(names.begin(), names.end(),
                                   [](const std::string& name) { return name.rfind(kOf, 0) == 0; });
  if (chosen == names.end()) return measured;
  MeasuredTable result = measured;
  result.columns.clear();
  for (MeasuredTable::Row& one : result.rows) one.values.clear();
  for (std::size_t from = kOf.size(); from <= chosen->size();) {
    const std::size_t end = std::min(chosen->find(", ", from), chosen->size());
    const auto& column = page::found(measured.columns, "column", chosen->substr(from, end - from),
                                     [](const MeasuredTable::Column& one) { return one.name; });
    result.columns.push_back(column);
    const auto index = static_cast<std::size_t>(&column - measured.columns.data());
    for (std::size_t i = 0; i < result.rows.size(); ++i)
      result.rows[i].values.push_back(measured.rows[i].values[index]);
    from = end + 2;
  }
  names.erase(chosen);
  return result;
}

std::string passage(page::PassageRequest request, const std::vector<MeasuredTable>& tables) {
  const MeasuredTable& measured =
      page::found(tables, "measured table", request.id, [](const MeasuredTable& one) { return one.name; });
  if (request.kind == "table" || request.kind == "across") {
    const MeasuredTable columns = narrowed(measured, request.names);
    if (request.kind == "table") return table(columns, request.names);
    page::requireNames(request, 1, measured.rows.size(), "across NAME; BEGINNING ...");
    return across(columns, request.names);
  }
  if (request.kind != "value") page::refuse("kind of passage", request.kind, {"table", "across", "value"});
  page::requireNames(request, 2, 2, "value NAME; ROW; COLUMN");
  const auto& ofRow = page::found(measured.rows, "row", request.names[0],
                                  [](const MeasuredTable::Row& one) { return one.name; });
  const auto& column = page::found(measured.columns, "column", request.names[1],
                                   [](const MeasuredTable::Column& one) { return one.name; });
  return cell(ofRow.values[static_cast<std::size_t>(&column - measured.columns.data())], column);
}

}  // namespace

std::string withMeasuredPassages(const std::string& markdown, const std::filesystem::path& file,
                                 const std::vector<MeasuredTable>& tables) {
  return page::withPassages(markdown, file, "measured",
                            [&](const page::PassageRequest& request) { return passage(request, tables); });
}

}  // namespace lumivox
