// The record of a report as JSON and CSV.
#include "page/data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "lumivox/analysis/slopes.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/json.h"
#include "results/csv.h"

namespace lumivox::page {
namespace {

using Json = nlohmann::ordered_json;
using results::csvField;

Json toJson(const AnalysedScene& scene) {
  Json json = lumivox::toJson(static_cast<const SceneRecord&>(scene));
  json["points"] = Json::array();
  for (const PointRecord& record : scene.points)
    json["points"].push_back(lumivox::toJson(record.point, record.isDefault));
  json["slopes"] = lumivox::toJson(slopesOf(pointsOf(scene)));
  json["pruning"] = Json::array();
  for (const PruningRecord& pruning : scene.pruning) json["pruning"].push_back(lumivox::toJson(pruning));
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

AnalysedReport analysed(const ReportRecord& record) {
  AnalysedReport data;
  static_cast<ReportRecord&>(data) = record;
  for (const SceneRecord& scene : record.scenes) {
    AnalysedScene one;
    static_cast<SceneRecord&>(one) = scene;
    one.comparisons = compareComponents(pointsOf(scene), {std::begin(kPageMetrics), std::end(kPageMetrics)},
                                        {record.equalTimesMs, record.equalErrors, scene.floor});
    data.analysed.push_back(std::move(one));
  }
  return data;
}

nlohmann::ordered_json toJson(const AnalysedReport& data) {
  Json json = {{"report", "lumivox"}, {"format", 1}, {"date", data.date}, {"command", data.commandLine}};
  json["device"] = {{"vendor", data.device.vendor},
                    {"renderer", data.device.renderer},
                    {"version", data.device.version},
                    {"platform", data.device.platform},
                    {"software", data.device.software},
                    {"shaders", data.shaderInput},
                    {"timer_queries_trusted", data.device.timerQueriesTrusted},
                    {"timer_note", data.device.timerNote},
                    {"host", data.host}};
  json["ceilings"] = lumivox::toJson(data.ceilings);
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
  for (const AnalysedScene& scene : data.analysed) json["scenes"].push_back(toJson(scene));
  if (!data.voxels.empty()) json["voxels"] = lumivox::toJson(data.voxels);
  for (const StressCell& cell : data.stress) json["stress"].push_back(lumivox::toJson(cell));
  return json;
}

std::string toCsv(const AnalysedReport& data) {
  std::string head, rows;
  for (const AnalysedScene& scene : data.analysed)
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

const PipelineComparison* comparisonOf(const AnalysedScene& scene, const std::string& component, bool bias,
                                       const std::string& metric) {
  const PipelineComparison* only = nullptr;
  for (const PipelineComparison& comparison : scene.comparisons) {
    if (comparison.component != component || comparison.metric != metric) continue;
    if (comparison.bias == bias) return &comparison;
    only = &comparison;
  }
  return only;
}

}  // namespace lumivox::page
