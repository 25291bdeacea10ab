// What deflate can hold: sizes that files claim are compared with it before memory is taken.
#pragma once

#include <cstdint>

namespace lumivox {

/// The most bytes that a byte of a deflated stream expands to: its longest match in the fewest bits.
inline constexpr std::uint64_t kMostDeflateExpansion = 1032;

}  // namespace lumivox
