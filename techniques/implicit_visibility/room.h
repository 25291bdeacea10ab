// Checks memory before it is allocated.
#pragma once

#include <cstdint>
#include <string>

namespace lumivox::implicit_visibility {

struct Need {
  std::string what;  ///< of elements
  std::uint64_t elements;
  std::uint64_t bytes;
  int bins = 0;  ///< along a side of a face; 0: none are involved
};
struct Room {
  std::string where;
  std::uint64_t bytes;
};

Room ofHost();

/// Error that names elements, bins, the bytes needed and available, and how many elements would fit.
void requireRoom(const Need& need, const Room& room);

}  // namespace lumivox::implicit_visibility
