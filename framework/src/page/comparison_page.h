// The part of a page that sets the pipelines of a scene against each other: error against run time.
#pragma once

#include <string>
#include <vector>

#include "page/data.h"

namespace lumivox::page {

/// Charts, fronts, equal time and equal error of every component. Needs the records as `scenes` in the block
/// "data", and kComparisonScript.
std::string comparisonSection(std::size_t sceneIndex, const AnalysedScene& scene);
extern const char* const kComparisonScript;

}  // namespace lumivox::page
