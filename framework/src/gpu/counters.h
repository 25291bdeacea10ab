// Numbers that OpenGL gives with fewer bits than they are kept in. No OpenGL here, so that no driver is
// needed to test it.
#pragma once

#include <cstdint>
#include <vector>

namespace lumivox::gpu {

/// Nanoseconds from one time stamp to a later one. The counter has `bits` bits (GL_QUERY_COUNTER_BITS, OpenGL
/// 4.5, 4.2) and begins again at 0 behind its largest number: one of 36 bits every 69 s.
constexpr std::uint64_t countedBetween(std::uint64_t begin, std::uint64_t end, int bits) {
  const std::uint64_t difference = end - begin;
  return bits > 0 && bits < 64 ? difference & ((std::uint64_t{1} << bits) - 1) : difference;
}

/// Whole rows of consecutive slices, or of one slice alone.
struct Rows {
  int firstSlice = 0, slices = 0, firstRow = 0, rows = 0;
  std::uint64_t offset = 0, bytes = 0;  ///< where they lie in memory that holds all
};

/// All rows of all slices in parts of at most `mostBytes`, in the order of memory, and as few of them as
/// there can be: whole slices where one fits, else whole rows. A row has to fit.
std::vector<Rows> partsOf(int slices, int rows, std::uint64_t rowBytes, std::uint64_t mostBytes);

}  // namespace lumivox::gpu
