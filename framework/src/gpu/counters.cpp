#include "gpu/counters.h"

#include <algorithm>
#include <cassert>

namespace lumivox::gpu {

std::vector<Rows> partsOf(int slices, int rows, std::uint64_t rowBytes, std::uint64_t mostBytes) {
  assert(slices > 0 && rows > 0 && rowBytes > 0 && rowBytes <= mostBytes);
  const std::uint64_t sliceBytes = rowBytes * static_cast<std::uint64_t>(rows);
  const auto upTo = [](std::uint64_t fitting, int count) {
    return static_cast<int>(std::min<std::uint64_t>(fitting, static_cast<std::uint64_t>(count)));
  };
  const bool whole = sliceBytes <= mostBytes;
  const int sliceStep = whole ? upTo(mostBytes / sliceBytes, slices) : 1;
  const int rowStep = whole ? rows : upTo(mostBytes / rowBytes, rows);
  std::vector<Rows> parts;
  for (int slice = 0; slice < slices; slice += sliceStep) {
    for (int row = 0; row < rows; row += rowStep) {
      Rows part{slice, std::min(sliceStep, slices - slice), row, std::min(rowStep, rows - row)};
      part.offset =
          static_cast<std::uint64_t>(slice) * sliceBytes + static_cast<std::uint64_t>(row) * rowBytes;
      part.bytes = rowBytes * static_cast<std::uint64_t>(part.rows) * static_cast<std::uint64_t>(part.slices);
      parts.push_back(part);
    }
  }
  return parts;
}

}  // namespace lumivox::gpu
