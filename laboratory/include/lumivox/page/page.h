// The page of a report: records in, one page out, with the same numbers as CSV and JSON beside it.
#pragma once

#include <filesystem>

#include "lumivox/results/report_record.h"

namespace lumivox {

struct ReportFiles {
  std::filesystem::path page, csv, json;
};
/// The page, and beside it the same stem with .csv and .json; index.html in a folder, which is what has no
/// extension. Error, so before any work, when one of them cannot be written or the packaged chart library is
/// absent.
ReportFiles reportFiles(const std::filesystem::path& output);

enum class ReportDetail {
  whole,
  brief  ///< of each scene the first screen alone, with the images of the default points; CSV and JSON are
         ///< whole
};

/// Every number of the page is in the JSON, but for those that a reader derives from others.
void writeReport(const ReportFiles& files, const ReportRecord& record,
                 ReportDetail detail = ReportDetail::whole);

}  // namespace lumivox
