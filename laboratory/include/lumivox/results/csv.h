// Comma-separated values (RFC 4180). Runs have one header, whichever command writes them, so that files of
// several commands can be put together: docs/reading_results.md.
#pragma once

#include <string>
#include <vector>

#include "lumivox/results/runs.h"
#include "lumivox/results/voxelizers.h"

namespace lumivox {

/// One row per run and error; a run without errors, one that failed for instance, has one row. The header is
/// the same for all runs but for the parameters.
std::string runsCsv(const std::vector<StoredRun>& runs);
/// What they share with runs is called as there.
std::string voxelizersCsv(const std::vector<VoxelizerRecord>& records, const gpu::DeviceInfo& device);

}  // namespace lumivox
