// The page of a report, with CSV and JSON beside it.
#include <algorithm>

#include "base/file_set.h"
#include "lumivox/analysis/comparison.h"
#include "lumivox/analysis/same_pipelines.h"
#include "lumivox/analysis/slopes.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/page/page.h"
#include "lumivox/results/csv.h"
#include "lumivox/results/json.h"
#include "page/document.h"
#include "page/markup.h"
#include "page/voxel_json.h"
#include "page_assets.h"

namespace lumivox::page {
namespace {

using Json = nlohmann::ordered_json;

/// The metrics that the page compares pipelines by.
constexpr const char* kMetrics[] = {kDefaultMetric, "rmse", "relative_mse", "percentile95"};

/// The time, ms, saved by leaving out passes or standing still, and whether the repeats suffice to claim it.
Json savingJson(const TimingStatistics& pruned, const TimingStatistics& unpruned) {
  const Measured before = medianOf(unpruned), after = medianOf(pruned);
  if (before.value <= 0.0 || unpruned.repeats == 0)
    return {{"told", "not_timed"}, {"ms", nullptr}, {"of_ms", nullptr}};
  const char* told = !decidable(before, after)                       ? "undecided"
                     : !differ(before, after, kSignificantTimeShare) ? "not_measurable"
                                                                     : "saved";
  return {
      {"told", told}, {"ms", numberJson(before.value - after.value)}, {"of_ms", numberJson(before.value)}};
}

Json sceneJson(const ReportRecord& record, const SceneRecord& scene) {
  Json json = toJson(scene);
  json["points"] = runsJson(runsOf(record, scene));
  const std::vector<const ReportPoint*> points = pointsOf(scene);
  json["slopes"] = toJson(slopesOf(points));
  json["pruning"] = Json::array();
  for (const PruningRecord& pruning : scene.pruning) {
    Json one = toJson(pruning);
    one["first_frame_saves"] = savingJson(pruning.prunedMs, pruning.unprunedMs);
    one["standing_saves"] = savingJson(pruning.nextPrunedMs, pruning.prunedMs);
    json["pruning"].push_back(std::move(one));
  }
  json["components"] = componentsOf(points);
  json["same_passes"] = samePipelines(points);
  json["comparisons"] = Json::array();
  const std::vector<PipelineComparison> comparisons =
      compareComponents(points, {std::begin(kMetrics), std::end(kMetrics)},
                        {record.equalTimesMs, record.equalErrors, scene.floor});
  for (const PipelineComparison& comparison : comparisons) json["comparisons"].push_back(toJson(comparison));
  const std::optional<std::size_t> led = ledComparison(comparisons);
  json["led_comparison"] = led ? Json(*led) : Json(nullptr);
  return json;
}

/// In the order of the scenes, points and outputs.
Json imagesJson(const ReportRecord& record, bool defaultPointsAlone) {
  Json scenes = Json::array();
  for (const SceneRecord& scene : record.scenes) {
    Json references = Json::array(), points = Json::array();
    for (const ReferenceRecord& reference : scene.references)
      references.push_back({{"layer", reference.layer}, {"png", base64(reference.image)}});
    for (const PointRecord& point : scene.points) {
      Json outputs = Json::array();
      for (const OutputImages& output : point.images) {
        if (defaultPointsAlone && !point.isDefault) continue;
        Json against = Json::array();
        for (const OutputImages::Against& map : output.against)
          against.push_back(
              {{"reference", map.reference}, {"flip", numberJson(map.flip)}, {"png", base64(map.flipMap)}});
        outputs.push_back({{"output", output.output},
                           {"component", output.component},
                           {"png", base64(output.image)},
                           {"against", std::move(against)}});
      }
      points.push_back(std::move(outputs));
    }
    scenes.push_back({{"references", std::move(references)}, {"points", std::move(points)}});
  }
  return {{"brief", defaultPointsAlone}, {"scenes", std::move(scenes)}};
}

/// The records, and what follows from them: comparisons of pipelines, slopes, growth. Everything but the
/// images.
Json reportJson(const ReportRecord& record) {
  Json json = {{"report", "lumivox"}, {"format", 1}, {"date", record.date}, {"command", record.commandLine}};
  json["device"] = {{"vendor", record.device.vendor},
                    {"renderer", record.device.renderer},
                    {"version", record.device.version},
                    {"platform", record.device.platform},
                    {"software", record.device.software},
                    {"shaders", record.shaderInput},
                    {"timer_queries_trusted", record.device.timerQueriesTrusted},
                    {"timer_note", record.device.timerNote},
                    {"host", record.host}};
  json["peak_rates"] = toJson(record.peakRates);
  json["units"] = {
      {"error", "radiance, W/(sr m^2)"}, {"flip", kDefaultMetricSays}, {"time", "ms"}, {"memory", "bytes"}};
  json["pipelines"] = Json::array();
  for (const PipelineRecord& pipeline : record.pipelines)
    json["pipelines"].push_back({{"file", pipeline.file}, {"name", pipeline.name}, {"hash", pipeline.hash}});
  json["techniques"] = Json::array();
  for (const TechniqueRecord& technique : record.techniques)
    json["techniques"].push_back({{"name", technique.name},
                                  {"library_hash", technique.libraryHash},
                                  {"shader_hash", technique.shaderHash},
                                  {"paper", technique.paper}});
  json["skipped"] = Json::array();
  for (const SkippedTechnique& skipped : record.skipped)
    json["skipped"].push_back({{"library", skipped.library.string()}, {"reason", skipped.reason}});
  json["least_repeats"] = kLeastRepeats;
  json["budget_s"] = record.budgetSeconds > 0.0 ? Json(record.budgetSeconds) : Json(nullptr);
  json["measuring_s"] = numberJson(record.measuringSeconds);
  json["look"] = record.isLook;
  json["complete"] = record.complete;
  json["scenes"] = Json::array();
  for (const SceneRecord& scene : record.scenes) json["scenes"].push_back(sceneJson(record, scene));
  if (!record.voxels.empty()) {
    json["voxels"] = toJson(record.voxels);
    json["voxel_scaling"] = scalingJson(record.voxels);
  }
  for (const StressCell& cell : record.stress) json["stress"].push_back(toJson(cell));
  return json;
}

}  // namespace
}  // namespace lumivox::page

namespace lumivox {

ReportFiles reportFiles(const std::filesystem::path& output) {
  // A folder, as other commands take it, holds the page under its usual name.
  const bool folder = !output.has_extension() || std::filesystem::is_directory(output);
  const std::filesystem::path file = folder ? output / "index.html" : output;
  const ReportFiles files{file, std::filesystem::path(file).replace_extension(".csv"),
                          std::filesystem::path(file).replace_extension(".json")};
  if (files.page == files.csv || files.page == files.json)
    throw Error(file.string() + ": the page cannot have the extension of the files beside it; use .html");
  for (const auto& one : {files.page, files.csv, files.json}) requireWritable(one);
  page::chartLibrary();
  return files;
}

void writeReport(const ReportFiles& files, const ReportRecord& record, ReportDetail detail) {
  const bool brief = detail == ReportDetail::brief;
  page::Document document{"Lumivox report",
                          page::reportJson(record),
                          page::imagesJson(record, brief),
                          true,
                          {page::assets::kComparisonJs, page::assets::kImagesJs, page::assets::kVoxelsJs,
                           page::assets::kStressJs, page::assets::kReportJs}};
  std::vector<StoredRun> runs;
  for (const SceneRecord& scene : record.scenes)
    for (StoredRun& run : runsOf(record, scene)) runs.push_back(std::move(run));
  const std::string json = textOf(document.data, 1) + "\n", csv = runsCsv(runs), html = page::html(document);
  writeFilesAtomically(std::vector<NewFile>{{files.json, json}, {files.csv, csv}, {files.page, html}});
}

}  // namespace lumivox
