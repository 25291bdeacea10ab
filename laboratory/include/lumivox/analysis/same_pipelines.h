// Pipelines that come to the same passes in a scene, once what it does not need is left out.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lumivox/results/records.h"

namespace lumivox {

/// Of each pipeline that comes to the same passes as another one, by file: that other one, which has fewer
/// parameters or comes first. It does when each of its points ran passes of the same names that did the same
/// work and made images with the same errors, bit for bit, as some point of the other. Smoke without a
/// medium, for instance, whose parameters then change nothing.
std::map<std::string, std::string> samePipelines(const std::vector<const ReportPoint*>& points);

}  // namespace lumivox
