// Phrases of findings and descriptions.
#pragma once

#include <string>
#include <vector>

#include "lumivox/dsl/schema.h"

namespace lumivox::dsl {

/// "one of a, b, c", or "a" when there is only one.
std::string oneOf(const std::vector<std::string>& words);
/// "a length (m, cm, mm or km)", "an angle such as 39 deg", "a number".
std::string quantity(const Dimension& dimension);
/// "from 1 to 179 deg", "at least 0", or empty.
std::string rangeText(const PropertySpecification& specification);
/// A number in base units as a reader would write it: angles in degrees.
std::string quantityText(double value, const Dimension& dimension);

}  // namespace lumivox::dsl
