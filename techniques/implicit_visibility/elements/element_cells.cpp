#include "element_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

namespace lumivox::implicit_visibility {

namespace {

/// Equals bucketOf() in neighbours.glsl.
std::uint32_t hashOf(const glm::ivec3& cell, std::uint32_t grid) {
  const glm::uvec3 words(cell);
  return words.x * 73856093u ^ words.y * 19349663u ^ words.z * 83492791u ^ grid * 2654435761u;
}

/// The power of two whose cube holds the support of an element of this radius.
int exponentFor(float radius) {
  return static_cast<int>(std::ceil(std::log2(2.0f * kReach * radius)));
}

}  // namespace

ElementCells::ElementCells(const ElementState& state, std::uint32_t leafCount) {
  const auto counts = [&](std::uint32_t leaf) {
    return state.area[leaf] > 0.0f && state.radius[leaf] > 0.0f;
  };
  std::set<int, std::greater<>> exponents;
  for (std::uint32_t leaf = 0; leaf < leafCount; ++leaf)
    if (counts(leaf)) exponents.insert(exponentFor(state.radius[leaf]));
  std::vector<int> kept(exponents.begin(), exponents.end());
  kept.resize(std::min<std::size_t>(kept.size(), kMostSizes));
  for (const int exponent : kept) cellSizes.push_back(std::ldexp(1.0f, exponent));

  buckets = std::bit_ceil(std::max(leafCount, 1u));
  starts.assign(std::size_t{buckets} + 1, 0);
  std::vector<std::array<std::uint32_t, 3>> entries;  // bucket, leaf, grid
  for (std::uint32_t leaf = 0; leaf < leafCount; ++leaf) {
    if (!counts(leaf)) continue;
    const int exponent = std::max(exponentFor(state.radius[leaf]), kept.back());
    const auto grid =
        static_cast<std::uint32_t>(std::find(kept.begin(), kept.end(), exponent) - kept.begin());
    const float inverse = std::ldexp(1.0f, -exponent);
    const glm::ivec3 cell(glm::floor(state.position[leaf] * inverse));
    entries.push_back({hashOf(cell, grid) & (buckets - 1), leaf, grid});
    ++starts[entries.back()[0] + 1];
  }
  for (std::uint32_t bucket = 0; bucket < buckets; ++bucket) starts[bucket + 1] += starts[bucket];
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
  leaves.resize(entries.size());
  for (const auto& [bucket, leaf, grid] : entries) leaves[next[bucket]++] = {leaf, grid};
}

}  // namespace lumivox::implicit_visibility
