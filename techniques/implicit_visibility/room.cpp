#include "room.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox::implicit_visibility {

Room ofHost() {
  return {"memory", availableMemory()};
}

void requireRoom(const Need& need, const Room& room) {
  if (need.bytes <= room.bytes) return;
  const std::string bins = need.bins > 0 ? fmt::format(" with 6 x {0} x {0} bins", need.bins) : "";
  throw Error(fmt::format("{} of {} elements{} need {}; {} has {}, enough for about {} elements", need.what,
                          need.elements, bins, formatBytes(need.bytes), room.where, formatBytes(room.bytes),
                          room.bytes / (need.bytes / need.elements)));
}

}  // namespace lumivox::implicit_visibility
