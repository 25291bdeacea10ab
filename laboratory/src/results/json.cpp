#include "lumivox/results/json.h"

#include <cmath>

#include "results/field_json.h"

namespace lumivox {
namespace {

using Json = nlohmann::ordered_json;

double millisecondsOf(const ReportPoint& point, const std::string& pass) {
  const auto time = point.passDeviceMs.find(pass);
  return time == point.passDeviceMs.end() ? 0.0 : time->second.median;
}

/// The work of a pass and its limit; null when it was not counted.
Json limitJson(const ReportPoint& point, const std::string& pass) {
  Json json = Json::object();
  const auto work = point.passWork.find(pass);
  if (work == point.passWork.end()) return nullptr;
  json["work"] = work->second;
  const auto bounds = point.passBounds.find(pass);
  const double ms = millisecondsOf(point, pass);
  if (bounds == point.passBounds.end() || bounds->second.empty() || !(ms > 0.0)) return json;
  json["limited_by"] = bounds->second.front().resource;
  json["of_peak_rate"] = bounds->second.front().ms / ms;
  Json least = Json::object();
  for (const WorkBound& bound : bounds->second) least[bound.resource] = bound.ms;
  json["at_least_ms"] = std::move(least);
  return json;
}

}  // namespace

Json numberJson(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string textOf(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Json toJson(const Measured& measured) {
  return {{"value", numberJson(measured.value)}, {"uncertainty", numberJson(measured.uncertainty)}};
}

Json toJson(const TimingStatistics& statistics) {
  Json json;
  results::fields(statistics, [&](const results::Field& field, auto number) {
    json[field.name] = results::jsonOf(number);
  });
  return json;
}

Json toJson(const ParameterValues& values) {
  Json json = Json::object();
  for (const auto& [name, value] : values)
    json[name] = value.word.empty() ? numberJson(value.number) : Json(value.word);
  return json;
}

Json toJson(const ComponentError& record) {
  const ImageError& error = record.error;
  return {{"output", record.output},
          {"component", record.component},
          {"reference", record.reference},
          {"kind", record.bias ? "bias" : "miss"},
          {"rmse", toJson(record.error.rmse)},
          {"seeds", record.seeds},
          {"deterministic", record.deterministic},
          {"enough_seeds", record.enoughSeeds()},
          {"rms_bias", toJson(record.parts.bias)},
          {"image_noise", numberJson(record.noiseRmse)},
          {"rms_noise", toJson(record.parts.noise)},
          {"flicker", toJson(record.flicker)},
          {"reference_noise", numberJson(error.noiseFloor)},
          {"relative_mse", toJson(error.relativeMse)},
          {"mean_ratio", toJson(error.meanRatio)},
          {"mean_difference", toJson(error.bias)},
          {"percentile_95", numberJson(error.percentile95)},
          {"percentile_95_uncertainty", numberJson(error.percentile95Uncertainty)},
          {"ssim", numberJson(error.ssim)},
          {"ssim_uncertainty", numberJson(error.ssimUncertainty)},
          {"flip_hdr", numberJson(error.flip)},
          {"flip_hdr_uncertainty", numberJson(error.flipUncertainty)},
          {"flip_ldr", numberJson(error.flipLdr)},
          {"flip_ldr_uncertainty", numberJson(error.flipLdrUncertainty)},
          {"exposure_ev", numberJson(error.exposure)},
          {"non_finite_image", error.nonFiniteImage},
          {"non_finite_reference", error.nonFiniteReference},
          {"rmse_of_nothing", numberJson(record.errorOfNothing.rmse.value)},
          {"ratio_to_nothing", numberJson(record.ratioToNothing())}};
}

Json toJson(const std::optional<GatheredVoxels>& voxels) {
  if (!voxels) return nullptr;
  Json json = results::jsonOf(*voxels);
  for (const auto& [name, value] : metricsOf(voxels)) json[name] = numberJson(value);
  return json;
}

Json runsJson(const std::vector<StoredRun>& runs) {
  Json list = Json::array();
  for (const StoredRun& run : runs) {
    Json json{{"run", run.id}, {"key", run.identity.key()}};
    json.update(results::jsonOf(run));
    list.push_back(std::move(json));
  }
  return list;
}

Json toJson(const ReportPoint& point, bool isDefault) {
  Json json = {{"scene", point.scene},
               {"pipeline", point.pipeline},
               {"sweep", point.sweep},
               {"default", isDefault},
               {"parameters", toJson(point.parameters)}};
  if (!point.failure.empty()) json["failure"] = point.failure;
  json["frame_ms"] = toJson(point.frameMs);
  json["next_frame_ms"] = toJson(point.nextFrameMs);
  json["still_frame_ms"] = toJson(point.stillFrameMs);
  json["moved_frame_ms"] = toJson(point.movedFrameMs);
  const CostParts parts = costParts(point);
  json["once_ms"] = toJson(parts.onceMs);
  json["when_moving_ms"] = toJson(parts.movingMs);
  json["every_frame_ms"] = toJson(parts.everyFrameMs);
  json["framework_share"] = numberJson(point.frameworkShare);
  json["peak_bytes"] = point.peakBytes;
  Json passes = Json::array();
  // A point that failed has no numbers, and one of an older store may lack some.
  const auto timeOf = [](const std::map<std::string, TimingStatistics>& times, const std::string& pass) {
    const auto found = times.find(pass);
    return found == times.end() ? Json(nullptr) : toJson(found->second);
  };
  for (const std::string& pass : point.passOrder) {
    const auto bytes = point.passBytes.find(pass);
    passes.push_back({{"pass", pass},
                      {"device_ms", timeOf(point.passDeviceMs, pass)},
                      {"host_ms", timeOf(point.passHostMs, pass)},
                      {"bytes", bytes == point.passBytes.end() ? Json(nullptr) : Json(bytes->second)},
                      {"limit", limitJson(point, pass)}});
  }
  json["passes"] = std::move(passes);
  Json errors = Json::array();
  for (const ComponentError& error : point.errors) errors.push_back(toJson(error));
  json["errors"] = std::move(errors);
  json["voxels"] = toJson(point.voxels);
  if (!point.whyNotCounted.empty()) json["why_not_counted"] = point.whyNotCounted;
  json["health_findings"] = point.healthFindings;
  json["notes"] = point.notes;
  json["command"] = point.command;
  return json;
}

Json toJson(const PruningRecord& record) {
  const auto time = [](const TimingStatistics& statistics) {
    return statistics.repeats == 0 ? Json(nullptr) : toJson(statistics);
  };
  const auto timeOf = [&](const std::map<std::string, TimingStatistics>& times, const std::string& pass) {
    const auto found = times.find(pass);
    return found == times.end() ? Json(nullptr) : time(found->second);
  };
  const auto share = [&](double value) { return record.prunedMs.repeats == 0 ? Json(nullptr) : Json(value); };
  const Explanation& explanation = record.explanation;
  Json json = {{"scene", record.scene},
               {"pipeline", record.pipeline},
               {"passes_kept", explanation.passesKept},
               {"passes_total", explanation.passesTotal},
               {"variants",
                {{"possible", explanation.variantsPossible},
                 {"compiled", explanation.variantsCompiled},
                 {"needed", explanation.variantsNeeded}}},
               {"frame_ms", time(record.prunedMs)},
               {"frame_ms_keep_everything", time(record.unprunedMs)},
               {"saved_share", share(record.savedShare())},
               {"next_frame_ms", time(record.nextPrunedMs)},
               {"next_frame_ms_keep_everything", time(record.nextUnprunedMs)},
               {"standing_share", share(record.standingShare())},
               {"bytes", record.prunedBytes},
               {"bytes_keep_everything", record.unprunedBytes},
               {"same_image", record.sameImage}};
  json["left_out"] = Json::array();
  for (const LeftOut& one : explanation.leftOut)
    json["left_out"].push_back({{"level", name(one.level)},
                                {"what", one.what},
                                {"why", one.why},
                                {"pass", one.pass},
                                {"saved_bytes", one.savedBytes},
                                {"saved_ms", numberJson(one.savedMs)}});
  json["passes"] = Json::array();
  for (const std::string& pass : record.passOrder)
    json["passes"].push_back({{"pass", pass},
                              {"ms", timeOf(record.prunedPassMs, pass)},
                              {"ms_keep_everything", timeOf(record.unprunedPassMs, pass)}});
  return json;
}

Json toJson(const std::vector<PeakRate>& peakRates) {
  Json list = Json::array();
  for (const PeakRate& peakRate : peakRates) list.push_back(results::jsonOf(peakRate));
  return list;
}

Json toJson(const VoxelizerRecord& record) {
  Json json = {{"scene", record.scene},         {"pipeline", record.pipeline},
               {"label", record.label()},       {"output", record.output},
               {"kind", record.kind},           {"resolution", record.resolution},
               {"triangles", record.triangles}, {"subdivisions", record.subdivisions},
               {"is_default", record.isDefault}};
  json["parameters"] = Json::object();
  for (const auto& [name, value] : record.parameters) json["parameters"][name] = value.text();
  if (!record.whyNot.empty()) {
    json["why_not"] = record.whyNot;
    return json;
  }
  json["grid"] = {
      {"low_m", {record.grid.low.x, record.grid.low.y, record.grid.low.z}},
      {"voxel_size_m", record.grid.voxelSize},
      {"resolution", {record.grid.resolution.x, record.grid.resolution.y, record.grid.resolution.z}}};
  json["frame_ms"] = toJson(record.frameMs);
  json["occupied"] = record.occupied;
  json["reference"] = record.reference;
  json["undecided"] = record.undecided;
  json["true_positive"] = record.error.truePositive;
  json["false_positive"] = record.error.falsePositive;
  json["false_negative"] = record.error.falseNegative;
  json["recall"] = record.error.recall();
  json["precision"] = record.error.precision();
  json["holes"] = results::jsonOf(record.holes);
  json["holes"]["axis_share"] = record.holes.axisShare();
  json["holes"]["oblique_share"] = record.holes.obliqueShare();
  json["fragments"] = record.fragments;
  json["bytes"] = record.bytes;
  json["allocated_bytes"] = record.allocatedBytes;
  json["bytes_per_fragment"] = record.bytesPerFragment();
  json["bytes_per_voxel"] = record.bytesPerVoxel();
  return json;
}

Json toJson(const std::vector<VoxelizerRecord>& records) {
  Json list = Json::array();
  for (const VoxelizerRecord& record : records) list.push_back(toJson(record));
  return list;
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
      {"tone", name(scene.display.tone)}};
  Json layers = Json::array();
  for (const ReferenceRecord& reference : scene.references)
    layers.push_back({{"layer", reference.layer},
                      {"noise", numberJson(reference.noise)},
                      {"mean", numberJson(reference.mean)},
                      {"largest", numberJson(reference.largest)},
                      {"exposure_ev", numberJson(reference.exposure)}});
  json["reference"]["layers"] = std::move(layers);
  json["left_out_points"] = Json::array();
  for (const LeftOutPoint& point : scene.leftOutPoints)
    json["left_out_points"].push_back(
        {{"pipeline", point.pipeline}, {"sweep", point.sweep}, {"parameters", toJson(point.parameters)}});
  json["left_out_prunings"] = scene.leftOutPrunings;
  json["unsuited"] = Json::array();
  for (const auto& [pipeline, why] : scene.unsuited)
    json["unsuited"].push_back({{"pipeline", pipeline}, {"why", why}});
  return json;
}

}  // namespace lumivox
