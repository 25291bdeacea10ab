// How the times of voxelisers grow, as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "lumivox/results/voxelisers.h"

namespace lumivox::page {

nlohmann::ordered_json scalingJson(const std::vector<VoxeliserRecord>& records);

}  // namespace lumivox::page
