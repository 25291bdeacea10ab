// Pipelines that come to the same passes in a scene, once what it does not need is left out.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lumivox/results/records.h"

namespace lumivox {

/// Of each pipeline that comes to the same passes as another one, by file: that other one, which has the
/// fewest parameters of them. Two pipelines do when their default points ran passes of the same names that did
/// the same work and made images with the same errors, bit for bit, and the first ran no other passes at any
/// of its points than the other. Smoke without a medium, for instance.
std::map<std::string, std::string> samePipelines(const std::vector<const ReportPoint*>& points);

}  // namespace lumivox
