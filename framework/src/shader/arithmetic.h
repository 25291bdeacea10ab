// Programs as a renderer ships them: without the marks that forbid a driver to fuse and to reorder.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lumivox::shader {

/// The module without its NoContraction decorations, those of `precise` in the source included. What is
/// Invariant stays so: passes that must agree on positions still do.
std::vector<std::uint32_t> withoutContractionMarks(std::span<const std::uint32_t> spirv);

}  // namespace lumivox::shader
