// The part of the page that says what each pass costs, and how far that is from what the device can do.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/data.h"

namespace lumivox::report {

std::string timeSection(std::size_t sceneIndex, const SceneRecord& scene);
/// What the device can do at most; empty without ceilings.
std::string ceilingSection(const std::vector<DeviceCeiling>& ceilings);

/// What a pass does, what that takes at least, and the share of that in its time.
nlohmann::ordered_json limitJson(const ReportPoint& point, const std::string& pass);

}  // namespace lumivox::report
