// Scans the output of a pass for values that no image may hold.
#pragma once

#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Appends a finding such as "pass gather, port diffuse: 3 NaN, first at pixel (12, 40)" for each texture
/// with NaN, infinite or, unless the kind of port allows them, negative values.
void scanHealth(const std::string& pass, const OutBase& output, std::vector<std::string>& findings);

}  // namespace lumivox
