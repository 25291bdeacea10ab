// The work that a run leaves out, grouped by reason.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"

namespace lumivox::command {

/// Everything that is left out for one reason at one level.
struct Reason {
  LeftOut::Level level;
  std::string why;
  std::vector<std::string> what;
  std::uint64_t bytes = 0;
  double ms = 0.0;
};

/// Reasons in the order of their first occurrence.
std::vector<Reason> reasonsOf(const Explanation& explanation);

}  // namespace lumivox::command
