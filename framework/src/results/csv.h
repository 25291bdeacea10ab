// Fields of CSV.
#pragma once

#include <string>

namespace lumivox::results {

/// One field of a CSV row (RFC 4180), quoted where it needs it.
std::string csvField(const std::string& text);

}  // namespace lumivox::results
