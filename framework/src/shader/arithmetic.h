// Programs as a released renderer has them: drivers may contract and reorder arithmetic.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lumivox::shader {

/// The module without its NoContraction decorations, including those of `precise` in the source. Invariant
/// decorations stay, so that passes still agree on positions.
std::vector<std::uint32_t> withoutContractionMarks(std::span<const std::uint32_t> spirv);

}  // namespace lumivox::shader
