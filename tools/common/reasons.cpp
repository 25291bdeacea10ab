#include "common/reasons.h"

#include <algorithm>

namespace lumivox::command {

std::vector<Reason> reasonsOf(const Explanation& explanation) {
  std::vector<Reason> reasons;
  for (const LeftOut& one : explanation.leftOut) {
    auto known = std::find_if(reasons.begin(), reasons.end(), [&](const Reason& reason) {
      return reason.level == one.level && reason.why == one.why;
    });
    if (known == reasons.end()) known = reasons.insert(known, {one.level, one.why, {}, 0, 0.0});
    known->what.push_back(one.what);
    known->bytes += one.savedBytes;
    known->ms += one.savedMs;
  }
  return reasons;
}

}  // namespace lumivox::command
