#include "lumivox/results/json.h"

#include <algorithm>
#include <cmath>

#include "results/field_json.h"

namespace lumivox {

using Json = nlohmann::ordered_json;

namespace results {

namespace {

void take(const auto& all, const std::string& name, auto& value) {
  if (const auto found = all.find(name); found != all.end()) value = found->second;
}

}  // namespace

std::vector<PassFields> passesOf(const ReportPoint& point) {
  std::vector<std::string> names = point.passOrder;
  for (const auto& [name, work] : point.passWork)
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  std::vector<PassFields> passes;
  for (const std::string& name : names) {
    PassFields& pass = passes.emplace_back();
    pass.name = name;
    pass.ran = passes.size() <= point.passOrder.size();
    take(point.passDeviceMs, name, pass.device);
    take(point.passHostMs, name, pass.host);
    take(point.passBytes, name, pass.bytes);
    take(point.passWork, name, pass.work);
    take(point.passBounds, name, pass.bounds);
  }
  return passes;
}

void addPass(ReportPoint& point, PassFields pass) {
  if (pass.device) point.passDeviceMs[pass.name] = *pass.device;
  if (pass.host) point.passHostMs[pass.name] = *pass.host;
  if (pass.bytes) point.passBytes[pass.name] = *pass.bytes;
  if (pass.work) point.passWork[pass.name] = std::move(*pass.work);
  if (pass.ran) point.passOrder.push_back(std::move(pass.name));
}

std::vector<PrunedPass> passesOf(const PruningRecord& record) {
  std::vector<PrunedPass> passes;
  for (const std::string& name : record.passOrder) {
    PrunedPass& pass = passes.emplace_back();
    pass.name = name;
    take(record.prunedPassMs, name, pass.ms);
    take(record.unprunedPassMs, name, pass.everythingMs);
  }
  return passes;
}

}  // namespace results

Json numberJson(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string textOf(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Json toJson(const Measured& measured) {
  return results::jsonOf(measured);
}

Json toJson(const TimingStatistics& statistics) {
  return results::jsonOf(statistics);
}

Json toJson(const ParameterValues& values) {
  return results::jsonOf(values);
}

Json toJson(const StoredRun& run) {
  Json json = Json::object();
  if (run.id != 0) json = {{"run", run.id}, {"key", run.identity.key()}};
  json.update(results::jsonOf(run));
  return json;
}

Json runsJson(const std::vector<StoredRun>& runs) {
  Json list = Json::array();
  for (const StoredRun& run : runs) list.push_back(toJson(run));
  return list;
}

Json toJson(const PruningRecord& record) {
  return results::jsonOf(record);
}

Json toJson(const std::vector<PeakRate>& peakRates) {
  return results::jsonOf(peakRates);
}

Json toJson(const std::vector<VoxelizerRecord>& records) {
  return results::jsonOf(records);
}

Json toJson(const SceneRecord& scene) {
  Json json = {{"file", scene.file},     {"name", scene.name},          {"hash", scene.hash},
               {"camera", scene.camera}, {"time_s", scene.time},        {"width", scene.width},
               {"height", scene.height}, {"triangles", scene.triangles}};
  json["reference"] = {
      {"samples_per_pixel", scene.referenceSamples},
      {"seconds", numberJson(scene.referenceSeconds)},
      {"attributes", scene.referenceAttributes},
      {"exposure_ev", numberJson(scene.display.exposure)},
      {"exposure_from", scene.exposureGiven ? "--exposure" : "log-average of the full reference"},
      {"tone", name(scene.display.tone)},
      {"layers", results::jsonOf(scene.references)}};
  json["left_out_points"] = results::jsonOf(scene.leftOutPoints);
  json["left_out_prunings"] = scene.leftOutPrunings;
  json["unsuited"] = Json::array();
  for (const auto& [pipeline, why] : scene.unsuited)
    json["unsuited"].push_back({{"pipeline", pipeline}, {"why", why}});
  return json;
}

}  // namespace lumivox
