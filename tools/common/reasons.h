// What runs leave out, grouped by why.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"

namespace lumivox::command {

/// What is left out for the same reason, at the same level.
struct Reason {
  LeftOut::Level level;
  std::string why;
  std::vector<std::string> what;
  std::uint64_t bytes = 0;
  double ms = 0.0;
};

/// In the order of the first of each.
std::vector<Reason> reasonsOf(const Explanation& explanation);

}  // namespace lumivox::command
