// Cells of the stress battery as JSON and CSV.
#include "lumivox/report/stress_cells.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "lumivox/base/error.h"
#include "report/data.h"
#include "report/stress_page.h"

namespace lumivox {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no NaN.
Json numberJson(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
double numberOf(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

/// The texts of a cell by name; one list serves reading, writing and the table's head.
template <class Cell, class Visit>
void visitTexts(Cell& cell, Visit visit) {
  visit("created", cell.created);
  visit("version", cell.version);
  visit("family", cell.family);
  visit("case", cell.name);
  visit("pipeline", cell.pipeline);
  visit("technique", cell.technique);
  visit("size", cell.size);
  visit("measure", cell.measure);
  visit("unit", cell.unit);
  visit("detail", cell.detail);
  visit("explanation", cell.explanation);
  visit("picture", cell.picture);
  visit("command", cell.command);
  visit("pipeline_hash", cell.pipelineHash);
  visit("framework", cell.framework);
  visit("device", cell.device);
  visit("driver", cell.driver);
  visit("shader_input", cell.shaderInput);
  visit("host", cell.host);
}

std::string dumped(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

namespace report {

Json stressJson(const StressCell& cell) {
  Json json;
  visitTexts(cell, [&](const char* key, const std::string& text) { json[key] = text; });
  if (cell.id != 0) json["id"] = cell.id;
  json["outcome"] = name(cell.outcome);
  json["value"] = numberJson(cell.value.value);
  json["uncertainty"] = numberJson(cell.value.uncertainty);
  json["limit"] = numberJson(cell.limit);
  json["seconds"] = numberJson(cell.seconds);
  json["techniques"] = cell.techniques;
  return json;
}

}  // namespace report

std::string stressCellJson(const StressCell& cell) {
  return dumped(report::stressJson(cell), -1);
}

StressCell stressCellFrom(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    StressCell cell;
    visitTexts(cell, [&](const char* key, std::string& into) { into = json.at(key).get<std::string>(); });
    const auto outcome = stressOutcomeNamed(json.at("outcome"));
    if (!outcome) throw Error("unknown outcome " + json.at("outcome").dump());
    cell.outcome = *outcome;
    cell.value = {numberOf(json.at("value")), numberOf(json.at("uncertainty"))};
    cell.limit = numberOf(json.at("limit"));
    cell.seconds = numberOf(json.at("seconds"));
    cell.techniques = json.at("techniques").get<std::map<std::string, std::string>>();
    return cell;
  } catch (const nlohmann::json::exception& error) {
    throw Error(fmt::format("'{}' is no cell of the stress battery: {}", text.substr(0, 200), error.what()));
  }
}

std::string stressCellsJson(const std::vector<StressCell>& cells) {
  Json list = Json::array();
  for (const StressCell& cell : cells) list.push_back(report::stressJson(cell));
  return dumped(list, 1) + "\n";
}

std::string stressCellsCsv(const std::vector<StressCell>& cells) {
  std::string text = "outcome,value,uncertainty,limit,seconds";
  visitTexts(static_cast<const StressCell&>(StressCell{}),
             [&](const char* key, const std::string&) { text += std::string(",") + key; });
  text += "\r\n";
  const auto exact = [](double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : std::string();
  };
  for (const StressCell& cell : cells) {
    text += fmt::format("{},{},{},{},{}", name(cell.outcome), exact(cell.value.value),
                        exact(cell.value.uncertainty), exact(cell.limit), exact(cell.seconds));
    visitTexts(cell, [&](const char*, const std::string& field) { text += "," + report::csvField(field); });
    text += "\r\n";
  }
  return text;
}

std::string stressValueText(const StressCell& cell) {
  std::string text = name(cell.outcome);
  if (cell.measure.empty() || cell.outcome == StressOutcome::broken ||
      cell.outcome == StressOutcome::refused || cell.outcome == StressOutcome::notApplicable)
    return text;
  return text + (std::isfinite(cell.value.value) ? fmt::format(" {:.3g}", cell.value.value) : " -") +
         (cell.unit.empty() ? "" : " " + cell.unit);
}

}  // namespace lumivox
