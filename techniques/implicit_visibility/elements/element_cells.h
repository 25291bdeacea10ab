// Finds the elements near a point by grids of cubes, one for each size of elements (neighbours.glsl).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "element_tree.h"

namespace lumivox::implicit_visibility {

/// Reach of a leaf's support in its radii: 1.5 times the distance of neighbours on a square lattice.
inline constexpr float kReach = 2.15f;
inline constexpr int kMostSizes = 16;

/// The leaves with area by the cube that their centre is in. Cubes of grid g are cellSizes[g] wide, a power
/// of two that is at least the diameter of the support of its leaves; the smallest of more than kMostSizes
/// sizes share one.
struct ElementCells {
  std::vector<float> cellSizes;
  std::uint32_t buckets = 1;                         ///< a power of two
  std::vector<std::uint32_t> starts;                 ///< of each bucket in `leaves`, and one more
  std::vector<std::array<std::uint32_t, 2>> leaves;  ///< leaf and grid, growing within a bucket

  ElementCells(const ElementState& state, std::uint32_t leafCount);
};

}  // namespace lumivox::implicit_visibility
