// The part of a page that shows how voxelisers do.
#pragma once

#include <string>
#include <vector>

#include "lumivox/results/voxelisers.h"

namespace lumivox::page {

/// Charts and tables with the heading "Voxels"; empty without records. Needs the records as `voxels` in the
/// block "data", and kVoxelScript.
std::string voxelSection(const std::vector<VoxeliserRecord>& records);
extern const char* const kVoxelScript;

}  // namespace lumivox::page
