// The part of a page that shows how voxelisers do.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lumivox/report/voxelisers.h"

namespace lumivox::report {

/// Charts and tables with the heading "Voxels"; empty without records. Needs the records as `voxels` in the
/// block "data", and kVoxelScript.
std::string voxelSection(const std::vector<VoxeliserRecord>& records);
nlohmann::ordered_json voxelRecordsJson(const std::vector<VoxeliserRecord>& records);
extern const char* const kVoxelScript;

}  // namespace lumivox::report
