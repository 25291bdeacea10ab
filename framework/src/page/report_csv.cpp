// The points of a report as CSV.
#include <fmt/format.h>

#include <cmath>

#include "page/report_files.h"
#include "results/csv.h"

namespace lumivox::page {
namespace {

using results::csvField;

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
  row.add("reference", error.reference);
  row.add("kind", error.output.empty() ? "" : error.bias ? "bias" : "miss");
  row.add("rmse", error.error.rmse);
  row.add("seeds", static_cast<std::uint64_t>(error.seeds));
  row.add("image_noise", error.noiseRmse);
  row.add("rms_bias", error.parts.bias);
  row.add("rms_noise", error.parts.noise);
  row.add("flicker", error.flicker);
  row.add("reference_noise", error.error.noiseFloor);
  row.add("relative_mse", error.error.relativeMse);
  row.add("mean_ratio", error.error.meanRatio);
  row.add("mean_difference", error.error.bias);
  const ImageError& e = error.error;
  row.add("percentile_95", Measured{e.percentile95, e.percentile95Uncertainty});
  row.add("ssim", Measured{e.ssim, e.ssimUncertainty});
  row.add("flip_hdr", Measured{e.flip, e.flipUncertainty});
  row.add("flip_ldr", Measured{e.flipLdr, e.flipLdrUncertainty});
  row.add("exposure_ev", e.exposure);
  row.add("non_finite_image", error.error.nonFiniteImage);
  row.add("non_finite_reference", error.error.nonFiniteReference);
  row.add("rmse_of_nothing", error.errorOfNothing.rmse.value);
  row.add("ratio_to_nothing", error.ratioToNothing());
  row.add("frame_ms", point.frameMs.median);
  row.add("frame_ms_lower_quartile", point.frameMs.lowerQuartile);
  row.add("frame_ms_upper_quartile", point.frameMs.upperQuartile);
  row.add("repeats", static_cast<std::uint64_t>(point.frameMs.repeats));
  row.add("next_frame_ms", point.nextFrameMs.median);
  const CostParts parts = costParts(point);
  row.add("once_ms", parts.onceMs);
  row.add("when_moving_ms", parts.movingMs);
  row.add("every_frame_ms", parts.everyFrameMs);
  row.add("framework_share", point.frameworkShare);
  row.add("peak_bytes", point.peakBytes);
  row.add("health_findings", std::uint64_t{point.healthFindings.size()});
  row.add("failure", record.point.failure);
  row.add("command", point.command);
  return row;
}

}  // namespace

std::string reportCsv(const ReportRecord& record) {
  std::string head, rows;
  for (const SceneRecord& scene : record.scenes)
    for (const PointRecord& point : scene.points) {
      std::vector<ComponentError> errors = point.point.errors;
      if (errors.empty())
        errors.emplace_back();  // a point that failed, or without any reference, still has its row
      for (const ComponentError& error : errors) {
        const CsvRow row = csvRow(scene, point, error);
        head = row.head();
        rows += row.row() + "\r\n";
      }
    }
  return head.empty() ? std::string() : head + "\r\n" + rows;
}

}  // namespace lumivox::page
