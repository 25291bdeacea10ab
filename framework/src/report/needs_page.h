// The parts of a page that say what a scene really needed.
#pragma once

#include <string>

#include "report/data.h"

namespace lumivox::report {

/// Scenes against pipelines: what was left out, at a glance. With its own heading "What was needed".
std::string neededMatrix(const ReportData& data);
/// One scene in full: what each pipeline left out, why, and what that saved, pass by pass.
std::string neededSection(const SceneRecord& scene);

}  // namespace lumivox::report
