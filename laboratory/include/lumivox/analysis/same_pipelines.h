// Pipelines that reduce to the same passes in a scene, once unneeded passes are left out.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lumivox/results/records.h"

namespace lumivox {

/// For each pipeline that reduces to the same passes as another one, by file: the other one, which has fewer
/// parameters or comes first. The condition: each of its points ran passes of the same names, with the same
/// work and the same errors, bit for bit, as some point of the other. Example: smoke without a medium.
std::map<std::string, std::string> samePipelines(const std::vector<const ReportPoint*>& points);

}  // namespace lumivox
