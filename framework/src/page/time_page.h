// The part of the page that says what each pass costs, and how far that is from what the device can do.
#pragma once

#include <string>
#include <vector>

#include "page/data.h"

namespace lumivox::page {

std::string timeSection(std::size_t sceneIndex, const AnalysedScene& scene);
/// What the device can do at most; empty without ceilings.
std::string ceilingSection(const std::vector<DeviceCeiling>& ceilings);

}  // namespace lumivox::page
