#include "lumivox/results/stress_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/base/hash.h"
#include "results/field_json.h"

namespace lumivox {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kOutcomes{"stable", "biased", "diverges", "refused", "not_applicable", "broken"};

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

std::string StressCell::anywhere() const {
  StressCell cell = *this;
  cell.device = cell.driver = cell.shaderInput = cell.host = {};
  return cell.key();
}

Json toJson(const StressCell& cell) {
  Json json = results::jsonOf(cell);
  if (cell.id != 0) json["id"] = cell.id;
  return json;
}

std::string stressCellJson(const StressCell& cell) {
  return textOf(toJson(cell), -1);
}

StressCell stressCellFrom(const std::string& json) {
  try {
    StressCell cell;
    const Json parsed = Json::parse(json);
    results::fields(cell, [&](const results::Field& field, auto&& member) {
      results::read(parsed.at(field.name), member);
    });
    return cell;
  } catch (const Json::exception& error) {
    throw Error(
        fmt::format("'{}' is not a cell of the stress battery: {}", json.substr(0, 200), error.what()));
  }
}

std::string stressCellsJson(const std::vector<StressCell>& cells) {
  Json list = Json::array();
  for (const StressCell& cell : cells) list.push_back(toJson(cell));
  return textOf(list, 1) + "\n";
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
