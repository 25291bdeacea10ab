// Cells of the stress battery as JSON, CSV and the page "Where each technique breaks".
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/report/store.h"

namespace lumivox {

/// One cell as a JSON object in one line, and back. Error for a text that is none.
std::string stressCellJson(const StressCell& cell);
StressCell stressCellFrom(const std::string& json);
/// All of them as an indented list, and one row each (RFC 4180).
std::string stressCellsJson(const std::vector<StressCell>& cells);
std::string stressCellsCsv(const std::vector<StressCell>& cells);

/// Writes `folder`/index.html and index.json; the pictures are there already. Returns the page. A cell whose
/// picture is not there has no link.
std::filesystem::path writeStressPage(const std::filesystem::path& folder,
                                      const std::vector<StressCell>& cells, const std::string& commandLine);

/// The newest cell of each pipeline and case, a quick one only where there is no full one.
std::vector<StressCell> newestCells(const std::vector<StressCell>& cells);

/// "biased 0.031": the outcome with its number, as matrices show it; the outcome alone without one.
std::string stressValueText(const StressCell& cell);

}  // namespace lumivox
