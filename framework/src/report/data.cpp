// The records as JSON and CSV.
#include "report/data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/report/device.h"
#include "report/slopes.h"
#include "report/stress_page.h"
#include "report/time_page.h"
#include "report/voxel_page.h"

namespace lumivox::report {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no NaN and no infinity.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json toJson(const Measured& measured) {
  return {{"value", number(measured.value)}, {"uncertainty", number(measured.uncertainty)}};
}

Json toJson(const TimingStatistics& statistics) {
  return {{"median", number(statistics.median)},
          {"lower_quartile", number(statistics.lowerQuartile)},
          {"upper_quartile", number(statistics.upperQuartile)},
          {"smallest", number(statistics.smallest)},
          {"largest", number(statistics.largest)},
          {"repeats", statistics.repeats}};
}

Json toJson(const ParameterValues& values) {
  Json json = Json::object();
  for (const auto& [name, value] : values)
    json[name] = value.word.empty() ? number(value.number) : Json(value.word);
  return json;
}

Json toJson(const ComponentError& record) {
  const PictureError& error = record.error;
  return {{"output", record.output},
          {"component", record.component},
          {"truth", record.truth},
          {"kind", record.bias ? "bias" : "miss"},
          {"rmse", toJson(record.error.rmse)},
          {"seeds", record.seeds},
          {"deterministic", record.deterministic},
          {"enough_seeds", record.enoughSeeds()},
          {"rms_bias", toJson(record.parts.bias)},
          {"picture_noise", number(record.noiseRmse)},
          {"rms_noise", toJson(record.parts.noise)},
          {"flicker", toJson(record.flicker)},
          {"truth_noise", number(error.noiseFloor)},
          {"relative_mse", toJson(error.relativeMse)},
          {"mean_ratio", toJson(error.meanRatio)},
          {"mean_difference", toJson(error.bias)},
          {"percentile_95", number(error.percentile95)},
          {"percentile_95_uncertainty", number(error.percentile95Uncertainty)},
          {"ssim", number(error.ssim)},
          {"ssim_uncertainty", number(error.ssimUncertainty)},
          {"flip_hdr", number(error.flip)},
          {"flip_hdr_uncertainty", number(error.flipUncertainty)},
          {"flip_ldr", number(error.flipLdr)},
          {"flip_ldr_uncertainty", number(error.flipLdrUncertainty)},
          {"non_finite_picture", error.nonFinitePicture},
          {"non_finite_truth", error.nonFiniteTruth},
          {"rmse_of_nothing", number(record.errorOfNothing.rmse.value)},
          {"ratio_to_nothing", number(record.ratioToNothing())}};
}

Json toJson(const PointRecord& record) {
  const ReportPoint& point = record.point;
  Json json = {{"scene", point.scene},
               {"pipeline", point.pipeline},
               {"sweep", point.sweep},
               {"default", record.isDefault},
               {"parameters", toJson(point.parameters)}};
  if (!record.point.failure.empty()) json["failure"] = record.point.failure;
  json["frame_ms"] = toJson(point.frameMs);
  json["next_frame_ms"] = toJson(point.nextFrameMs);
  json["framework_share"] = number(point.frameworkShare);
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
  json["health_findings"] = point.healthFindings;
  json["notes"] = point.notes;
  json["command"] = point.command;
  return json;
}

Json toJson(const PruningRecord& record) {
  Json json = {{"pipeline", record.pipeline},
               {"passes_kept", record.explanation.passesKept},
               {"passes_total", record.explanation.passesTotal},
               {"variants",
                {{"possible", record.explanation.variantsPossible},
                 {"compiled", record.explanation.variantsCompiled},
                 {"needed", record.explanation.variantsNeeded}}},
               {"pruned_frame_ms", toJson(record.prunedMs)},
               {"unpruned_frame_ms", toJson(record.unprunedMs)},
               {"saved_share", number(record.savedShare())},
               {"pruned_next_frame_ms", toJson(record.nextPrunedMs)},
               {"unpruned_next_frame_ms", toJson(record.nextUnprunedMs)},
               {"saved_share_next", number(record.savedShareNext())},
               {"pruned_bytes", record.prunedBytes},
               {"unpruned_bytes", record.unprunedBytes},
               {"same_picture", record.samePicture}};
  Json leftOut = Json::array();
  for (const LeftOut& one : record.explanation.leftOut)
    leftOut.push_back({{"level", name(one.level)},
                       {"what", one.what},
                       {"why", one.why},
                       {"saved_bytes", one.savedBytes},
                       {"saved_ms", number(one.savedMs)}});
  json["left_out"] = std::move(leftOut);
  Json passes = Json::array();
  for (const std::string& pass : record.passOrder) {
    const auto pruned = record.prunedPassMs.find(pass);
    const auto unpruned = record.unprunedPassMs.find(pass);
    passes.push_back(
        {{"pass", pass},
         {"pruned_ms", pruned == record.prunedPassMs.end() ? Json(nullptr) : toJson(pruned->second)},
         {"unpruned_ms",
          unpruned == record.unprunedPassMs.end() ? Json(nullptr) : toJson(unpruned->second)}});
  }
  json["passes"] = std::move(passes);
  return json;
}

Json toJson(const SceneRecord& scene) {
  Json json = {{"file", scene.file},     {"name", scene.name},          {"hash", scene.hash},
               {"camera", scene.camera}, {"time_s", scene.time},        {"width", scene.width},
               {"height", scene.height}, {"triangles", scene.triangles}};
  json["truth"] = {{"samples_per_pixel", scene.truthSamples},
                   {"seconds", number(scene.truthSeconds)},
                   {"attributes", scene.truthAttributes}};
  Json layers = Json::array();
  for (const TruthRecord& truth : scene.truths)
    layers.push_back({{"layer", truth.layer},
                      {"noise", number(truth.noise)},
                      {"mean", number(truth.mean)},
                      {"largest", number(truth.largest)},
                      {"display_exposure", number(truth.exposure)}});
  json["truth"]["layers"] = std::move(layers);
  json["points"] = Json::array();
  for (const PointRecord& point : scene.points) json["points"].push_back(toJson(point));
  json["slopes"] = slopesJson(slopesOf(scene));
  json["pruning"] = Json::array();
  for (const PruningRecord& pruning : scene.pruning) json["pruning"].push_back(toJson(pruning));
  json["unsuited"] = Json::array();
  for (const auto& [pipeline, why] : scene.unsuited)
    json["unsuited"].push_back({{"pipeline", pipeline}, {"why", why}});
  json["comparisons"] = Json::array();
  for (const PipelineComparison& comparison : scene.comparisons)
    json["comparisons"].push_back(lumivox::toJson(comparison));
  return json;
}

std::string csvNumber(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : std::string();
}

/// The columns of a row, added by name once for the head line and by value for every row.
class CsvRow {
 public:
  void add(const char* column, const std::string& value) {
    head_ += (head_.empty() ? "" : ",") + std::string(column);
    row_ += (first_ ? "" : ",") + csvField(value);
    first_ = false;
  }
  void add(const char* column, double value) { add(column, csvNumber(value)); }
  void add(const char* column, std::uint64_t value) { add(column, fmt::format("{}", value)); }
  void add(const char* column, const Measured& value) {
    add(column, value.value);
    add((std::string(column) + "_uncertainty").c_str(), value.uncertainty);
  }
  const std::string& head() const { return head_; }
  const std::string& row() const { return row_; }

 private:
  std::string head_, row_;
  bool first_ = true;
};

CsvRow csvRow(const SceneRecord& scene, const PointRecord& record, const ComponentError& error) {
  const ReportPoint& point = record.point;
  std::string parameters;
  for (const auto& [name, value] : point.parameters)
    parameters += (parameters.empty() ? "" : " ") + name + "=" + value.text();
  CsvRow row;
  row.add("scene", point.scene);
  row.add("pipeline", point.pipeline);
  row.add("sweep", point.sweep);
  row.add("parameters", parameters);
  row.add("default", std::uint64_t{record.isDefault});
  row.add("width", static_cast<std::uint64_t>(scene.width));
  row.add("height", static_cast<std::uint64_t>(scene.height));
  row.add("output", error.output);
  row.add("component", error.component);
  row.add("truth", error.truth);
  row.add("kind", error.output.empty() ? "" : error.bias ? "bias" : "miss");
  row.add("rmse", error.error.rmse);
  row.add("seeds", static_cast<std::uint64_t>(error.seeds));
  row.add("picture_noise", error.noiseRmse);
  row.add("rms_bias", error.parts.bias);
  row.add("rms_noise", error.parts.noise);
  row.add("flicker", error.flicker);
  row.add("truth_noise", error.error.noiseFloor);
  row.add("relative_mse", error.error.relativeMse);
  row.add("mean_ratio", error.error.meanRatio);
  row.add("mean_difference", error.error.bias);
  const PictureError& e = error.error;
  row.add("percentile_95", Measured{e.percentile95, e.percentile95Uncertainty});
  row.add("ssim", Measured{e.ssim, e.ssimUncertainty});
  row.add("flip_hdr", Measured{e.flip, e.flipUncertainty});
  row.add("flip_ldr", Measured{e.flipLdr, e.flipLdrUncertainty});
  row.add("non_finite_picture", error.error.nonFinitePicture);
  row.add("non_finite_truth", error.error.nonFiniteTruth);
  row.add("rmse_of_nothing", error.errorOfNothing.rmse.value);
  row.add("ratio_to_nothing", error.ratioToNothing());
  row.add("frame_ms", point.frameMs.median);
  row.add("frame_ms_lower_quartile", point.frameMs.lowerQuartile);
  row.add("frame_ms_upper_quartile", point.frameMs.upperQuartile);
  row.add("repeats", static_cast<std::uint64_t>(point.frameMs.repeats));
  row.add("next_frame_ms", point.nextFrameMs.median);
  row.add("framework_share", point.frameworkShare);
  row.add("peak_bytes", point.peakBytes);
  row.add("health_findings", std::uint64_t{point.healthFindings.size()});
  row.add("failure", record.point.failure);
  row.add("command", point.command);
  return row;
}

}  // namespace

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

nlohmann::ordered_json toJson(const ReportData& data) {
  Json json = {
      {"report", "lumivox"}, {"format", 1}, {"date", data.date}, {"command", data.options.commandLine}};
  json["device"] = {{"vendor", data.device.vendor},
                    {"renderer", data.device.renderer},
                    {"version", data.device.version},
                    {"platform", data.device.platform},
                    {"software", data.device.software},
                    {"shaders", data.shaderInput},
                    {"timer_queries_trusted", data.device.timerQueriesTrusted},
                    {"timer_note", data.device.timerNote},
                    {"host", data.host}};
  json["ceilings"] = ceilingsJson(data.ceilings);
  json["units"] = {{"error", "radiance, W/(sr m^2)"}, {"time", "ms"}, {"memory", "bytes"}};
  json["pipelines"] = Json::array();
  for (const PipelineRecord& pipeline : data.pipelines)
    json["pipelines"].push_back({{"file", pipeline.file}, {"name", pipeline.name}, {"hash", pipeline.hash}});
  json["techniques"] = Json::array();
  for (const TechniqueRecord& technique : data.techniques)
    json["techniques"].push_back({{"name", technique.name},
                                  {"library_hash", technique.libraryHash},
                                  {"shader_hash", technique.shaderHash},
                                  {"paper", technique.paper}});
  json["scenes"] = Json::array();
  for (const SceneRecord& scene : data.scenes) json["scenes"].push_back(toJson(scene));
  if (!data.voxels.empty()) json["voxels"] = voxelRecordsJson(data.voxels);
  for (const StressCell& cell : data.stress) json["stress"].push_back(stressJson(cell));
  return json;
}

std::string toCsv(const ReportData& data) {
  std::string head, rows;
  for (const SceneRecord& scene : data.scenes)
    for (const PointRecord& point : scene.points) {
      std::vector<ComponentError> errors = point.point.errors;
      if (errors.empty())
        errors.emplace_back();  // a point that failed, or without any truth, still has its row
      for (const ComponentError& error : errors) {
        const CsvRow row = csvRow(scene, point, error);
        head = row.head();
        rows += row.row() + "\r\n";
      }
    }
  return head.empty() ? std::string() : head + "\r\n" + rows;
}

std::string chartLibrary() {
  const std::vector<std::string> places = [] {
    std::vector<std::string> list;
    if (const char* given = std::getenv("LUMIVOX_CHART_JS"); given != nullptr && *given != '\0')
      list.emplace_back(given);
    else
      list = {"/usr/share/javascript/chart.js/chart.min.js", "/usr/share/javascript/chart.js/Chart.min.js"};
    return list;
  }();
  std::string sought;
  for (const std::string& place : places) {
    std::error_code failure;
    if (std::filesystem::is_regular_file(place, failure)) {
      std::string text = readFile(place);
      if (text.find("Chart.js v3") == std::string::npos)
        throw Error(place + ": not Chart.js 3; the report needs the Debian package libjs-chart.js");
      return text;
    }
    sought += (sought.empty() ? "" : ", ") + place;
  }
  throw AbsentError("Chart.js not found; the report needs the Debian package libjs-chart.js; sought: " +
                    sought);
}

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";  // RFC 4648, Sec. 4
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = (group << 8) | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j)
      text += i + j <= bytes.size() ? kDigits[(group >> (18 - 6 * j)) & 63u] : '=';
  }
  return text;
}

std::vector<std::string> componentsOf(const std::vector<const ReportPoint*>& points) {
  std::vector<std::string> present;
  for (const std::string& component : comparableComponents()) {
    const auto has = [&](const ReportPoint* point) { return errorOf(*point, component, true) != nullptr; };
    if (std::any_of(points.begin(), points.end(), has)) present.push_back(component);
  }
  return present;
}

std::vector<const ReportPoint*> pointsOf(const SceneRecord& scene) {
  std::vector<const ReportPoint*> points;
  for (const PointRecord& record : scene.points) points.push_back(&record.point);
  return points;
}

const ComponentError* errorOf(const ReportPoint& point, const std::string& component, bool bias) {
  const bool whole = component == name(Contributes::final);
  const ComponentError* only = nullptr;
  for (const ComponentError& error : point.errors) {
    if (error.component != component || (whole && error.output != kWholePicture)) continue;
    if (error.bias == bias) return &error;
    if (only == nullptr) only = &error;
  }
  return only;
}

const PipelineComparison* comparisonOf(const SceneRecord& scene, const std::string& component, bool bias,
                                       const std::string& metric) {
  const PipelineComparison* only = nullptr;
  for (const PipelineComparison& comparison : scene.comparisons) {
    if (comparison.component != component || comparison.metric != metric) continue;
    if (comparison.bias == bias) return &comparison;
    only = &comparison;
  }
  return only;
}

}  // namespace lumivox::report
