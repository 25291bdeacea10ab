// Stored results as tables and JSON.
#pragma once

#include <string>
#include <vector>

#include "common/command_line.h"
#include "lumivox/results/store.h"

namespace lumivox::command {

/// Null for NaN and infinity, which JSON does not have.
Json jsonNumber(double value);

/// One row per run; errors of the outputs beside the frame time. Below kWideColumns one line per run, with
/// the error of the whole image alone.
std::string runsTable(const std::vector<StoredRun>& runs);
Json runsJson(const std::vector<StoredRun>& runs);

}  // namespace lumivox::command
