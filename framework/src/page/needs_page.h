// The parts of a page that say what a scene really needed.
#pragma once

#include <string>

#include "page/data.h"

namespace lumivox::page {

/// Scenes against pipelines: what was left out, at a glance. With its own heading "What was needed".
std::string neededMatrix(const AnalysedReport& data);
/// One scene in full: what each pipeline left out, why, and what that saved, pass by pass.
std::string neededSection(const AnalysedScene& scene);

}  // namespace lumivox::page
