// A bit for each node that a tree over a grid could have. GLSL side: shaders/toolkit/bit_tree.glsl.
#pragma once

#include <cstdint>

#include "lumivox/scene/grid.h"

namespace lumivox {

/// Depth of the finest voxels in the smallest tree over a grid, whose root is at depth 0.
inline int voxelDepthOver(const GridPlacement& grid) {
  int depth = 1;
  while ((1 << depth) < grid.longest()) ++depth;
  return depth;
}

/// Words of bits of all depths before this one.
inline std::uint64_t wordsBeforeDepth(int depth) {
  return depth < 2 ? static_cast<std::uint64_t>(depth) : 2 + ((std::uint64_t{1} << (3 * depth - 5)) - 2) / 7;
}

}  // namespace lumivox
