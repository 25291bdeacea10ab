#include "shader/arithmetic.h"

#include <algorithm>

namespace lumivox::shader {

std::vector<std::uint32_t> withoutContractionMarks(std::span<const std::uint32_t> spirv) {
  // SPIR-V 1.0, sections 2.3 (layout of a module), 3.20 (decorations) and 3.32.3 (OpDecorate).
  constexpr std::size_t kHeader = 5;
  constexpr std::uint32_t kOpDecorate = 71, kNoContraction = 42;
  std::vector<std::uint32_t> kept(spirv.begin(), spirv.begin() + std::min(kHeader, spirv.size()));
  kept.reserve(spirv.size());
  for (std::size_t at = kHeader; at < spirv.size();) {
    const std::size_t length = spirv[at] >> 16;
    if (length == 0 || at + length > spirv.size())
      return {spirv.begin(), spirv.end()};  // the driver reports the error
    const bool mark = (spirv[at] & 0xffffu) == kOpDecorate && length == 3 && spirv[at + 2] == kNoContraction;
    if (!mark) kept.insert(kept.end(), spirv.begin() + at, spirv.begin() + at + length);
    at += length;
  }
  return kept;
}

}  // namespace lumivox::shader
