// The files of a report as texts.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lumivox/results/report_record.h"

namespace lumivox::page {

/// The records, and what follows from them: comparisons of pipelines, slopes, growth. Everything but the
/// images.
nlohmann::ordered_json reportJson(const ReportRecord& record);
/// One row per point, output and reference layer (RFC 4180).
std::string reportCsv(const ReportRecord& record);

}  // namespace lumivox::page
