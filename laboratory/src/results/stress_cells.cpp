#include "lumivox/results/stress_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "lumivox/base/error.h"
#include "lumivox/base/hash.h"
#include "lumivox/results/csv.h"
#include "lumivox/results/json.h"

namespace lumivox {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kOutcomes{"stable", "biased", "diverges", "refused", "not_applicable", "broken"};

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
  visit("image", cell.image);
  visit("command", cell.command);
  visit("pipeline_hash", cell.pipelineHash);
  visit("framework", cell.framework);
  visit("device", cell.device);
  visit("driver", cell.driver);
  visit("shader_input", cell.shaderInput);
  visit("host", cell.host);
}

}  // namespace

const char* name(StressOutcome outcome) {
  return kOutcomes.at(static_cast<std::size_t>(outcome));
}

std::optional<StressOutcome> stressOutcomeNamed(const std::string& name) {
  for (std::size_t i = 0; i < kOutcomes.size(); ++i)
    if (name == kOutcomes[i]) return static_cast<StressOutcome>(i);
  return std::nullopt;
}

std::string StressCell::key() const {
  Hasher hasher;
  hasher.add(family).add(name).add(pipelineHash).add(size).add(framework);
  hasher.add(std::uint64_t{techniques.size()});
  for (const auto& [used, hash] : techniques) hasher.add(used).add(hash);
  hasher.add(device).add(driver).add(shaderInput).add(host);
  return hasher.finish().text();
}

Json toJson(const StressCell& cell) {
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

std::string stressCellJson(const StressCell& cell) {
  return textOf(toJson(cell), -1);
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
    throw Error(
        fmt::format("'{}' is not a cell of the stress battery: {}", text.substr(0, 200), error.what()));
  }
}

std::string stressCellsJson(const std::vector<StressCell>& cells) {
  Json list = Json::array();
  for (const StressCell& cell : cells) list.push_back(toJson(cell));
  return textOf(list, 1) + "\n";
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
    visitTexts(cell, [&](const char*, const std::string& field) { text += "," + csvField(field); });
    text += "\r\n";
  }
  return text;
}

std::vector<StressCell> newestCells(const std::vector<StressCell>& cells) {
  std::vector<StressCell> newest;
  for (const StressCell& cell : cells) {
    const auto same = std::find_if(newest.begin(), newest.end(), [&](const StressCell& other) {
      return other.name == cell.name && other.pipeline == cell.pipeline;
    });
    if (same == newest.end())
      newest.push_back(cell);
    else if (cell.size == same->size ? cell.created >= same->created : cell.size == "full")
      *same = cell;
  }
  return newest;
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
