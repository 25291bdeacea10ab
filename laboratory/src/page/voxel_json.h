// How the times of voxelizers grow, as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "lumivox/results/voxelizers.h"

namespace lumivox::page {

nlohmann::ordered_json scalingJson(const std::vector<VoxelizerRecord>& records);

}  // namespace lumivox::page
