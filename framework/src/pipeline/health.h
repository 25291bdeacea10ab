// Scan of a pass's output for values that no image may hold.
#pragma once

#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// Appends "pass gather, port diffuse: 3 NaN, first at pixel (12, 40)" for each texture of the output that
/// holds NaN or infinite values, or negative ones where the kind of port allows none.
void scanHealth(const std::string& pass, const OutBase& output, std::vector<std::string>& findings);

}  // namespace lumivox
