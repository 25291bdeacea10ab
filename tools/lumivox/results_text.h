// Stored results as tables.
#pragma once

#include <string>
#include <vector>

#include "lumivox/results/store.h"

namespace lumivox::command {

/// One row per run, with its frame time and the errors of its outputs. On a terminal below kWideColumns, one
/// line per run with the error of the whole image alone.
std::string runsTable(const std::vector<StoredRun>& runs);

}  // namespace lumivox::command
