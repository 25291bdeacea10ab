// A report's records with what is found from them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lumivox/analysis/comparison.h"
#include "lumivox/results/report_record.h"

namespace lumivox::page {

struct AnalysedScene : SceneRecord {
  std::vector<PipelineComparison> comparisons;
};

struct AnalysedReport : ReportRecord {
  std::vector<AnalysedScene> analysed;  ///< the scenes
};
AnalysedReport analysed(const ReportRecord& record);

/// The metrics that the page compares pipelines by.
inline constexpr const char* kPageMetrics[] = {"rmse", "relative_mse", "percentile95", "flip"};

/// Everything but the pictures.
nlohmann::ordered_json toJson(const AnalysedReport& data);
/// One row per point, output and truth layer (RFC 4180).
std::string toCsv(const AnalysedReport& data);

/// The one self-contained page. `chartLibrary` is the text of Chart.js.
std::string toHtml(const AnalysedReport& data, const std::string& chartLibrary);

/// Chart.js of the distribution (package libjs-chart.js). AbsentError names the package and where it was
/// sought.
std::string chartLibrary();

std::string base64(const std::string& bytes);

/// The comparison of a component by a metric; null when no point has it. One truth answers for both.
const PipelineComparison* comparisonOf(const AnalysedScene& scene, const std::string& component, bool bias,
                                       const std::string& metric);

}  // namespace lumivox::page
