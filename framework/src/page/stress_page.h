// The page "Where each technique breaks", and the same as a section of a report.
#pragma once

#include <string>
#include <vector>

#include "lumivox/results/stress_cells.h"

namespace lumivox::page {

/// The matrix of pipelines and cases, the cells that are not stable with number, detail, explanation and
/// command, and the stable ones in a table to be opened. Empty without cells. `pictures`: a folder beside the
/// page that holds the cells' pictures; empty: no links. Needs kStressStyle.
std::string stressSection(const std::vector<StressCell>& cells, const std::string& pictures);
extern const char* const kStressStyle;

}  // namespace lumivox::page
