// Numbers that OpenGL returns with fewer bits than they are stored in. Without OpenGL, so that tests need no
// driver.
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
  std::uint64_t offset = 0, bytes = 0;  ///< their place in memory that holds all
};

/// All rows of all slices in as few parts of at most `mostBytes` as possible, in the order of memory: whole
/// slices if one fits, else whole rows. Precondition: a row fits.
std::vector<Rows> partsOf(int slices, int rows, std::uint64_t rowBytes, std::uint64_t mostBytes);

}  // namespace lumivox::gpu
