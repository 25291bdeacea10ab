// Rays through one bit a voxel. GLSL side: shaders/common/bit_grid.glsl.
#pragma once

#include <cstdint>

#include "lumivox/pipeline/ports/binary_grid.h"

namespace lumivox {

/// Upper bound of the loop iterations of one step from texel to texel: over the layers of a stack and their
/// end; twice two loops that correct a cell, each by one voxel, and their ends.
constexpr std::int64_t turnsOfBitStep(const BinaryGrid& bits) {
  return (bits.grid.resolution.z + BinaryGrid::kStack - 1) / BinaryGrid::kStack + 1 + 2 * 2 * 2;
}

/// Upper bound of the steps of one ray with BIT_RULE hierarchy: it goes down once for each time that it went
/// up, and goes up only when it leaves a block of columns.
constexpr std::int64_t hierarchyTurns(const BinaryGrid& bits) {
  return turnsOfBitStep(bits) * (2 * (std::int64_t{bits.grid.resolution.x} + bits.grid.resolution.y) + 16);
}

}  // namespace lumivox
