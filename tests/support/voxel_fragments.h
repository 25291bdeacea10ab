// Lists of voxel fragments, read back and unpacked.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/packing.hpp>
#include <set>
#include <vector>

#include "lumivox/pipeline/ports.h"
#include "support/support.h"

namespace lumivox::test {

/// Mirror of VoxelFragment in shaders/common/voxel.glsl.
struct FragmentData {
  std::uint32_t voxel, offset, normal, albedoRg, albedoBCoverage, emission;
  static constexpr std::uint32_t kLobeSteps = 27;
  auto operator<=>(const FragmentData&) const = default;

  static glm::ivec3 tenBits(std::uint32_t packed) {
    return {static_cast<int>(packed & 1023), static_cast<int>(packed >> 10 & 1023),
            static_cast<int>(packed >> 20 & 1023)};
  }
  glm::ivec3 cell() const { return tenBits(voxel); }
  /// Position in the grid, in voxels.
  glm::dvec3 position() const { return glm::dvec3(cell()) + glm::dvec3(tenBits(offset)) / 1023.0; }
  glm::vec3 albedo() const {
    return glm::vec3(glm::unpackHalf2x16(albedoRg), glm::unpackHalf2x16(albedoBCoverage).x);
  }
  float coverage() const { return glm::unpackHalf2x16(albedoBCoverage).y; }
  glm::vec3 unitNormal() const {
    const glm::vec2 p = glm::unpackSnorm2x16(normal);
    glm::vec3 n(p, 1.0f - std::abs(p.x) - std::abs(p.y));
    if (n.z < 0.0f) {
      const glm::vec2 folded = 1.0f - glm::abs(glm::vec2(n.y, n.x));
      n.x = n.x >= 0.0f ? folded.x : -folded.x;
      n.y = n.y >= 0.0f ? folded.y : -folded.y;
    }
    return glm::normalize(n);
  }
  glm::vec3 emittedRadiance() const {
    if (emission >> 24 <= kLobeSteps) return glm::vec3(0.0f);
    const float unit = std::ldexp(1.0f, static_cast<int>(emission >> 24) - 128 - 8);
    return glm::vec3(emission & 255, emission >> 8 & 255, emission >> 16 & 255) * unit;
  }
};

/// All fragments in sorted order, since the order of a list varies.
inline std::vector<FragmentData> fragmentsOf(const VoxelFragments& list) {
  const std::uint32_t count = list.count->downloadValues<std::uint32_t>()[0];
  std::vector<FragmentData> fragments = list.fragments->downloadValues<FragmentData>();
  REQUIRE(count <= fragments.size());
  fragments.resize(count);
  std::sort(fragments.begin(), fragments.end());
  return fragments;
}

using Cell = std::array<int, 3>;

inline std::set<Cell> cellsOf(const std::vector<FragmentData>& fragments) {
  std::set<Cell> cells;
  for (const FragmentData& fragment : fragments) {
    const glm::ivec3 cell = fragment.cell();
    cells.insert({cell.x, cell.y, cell.z});
  }
  return cells;
}

/// The voxels of a grid of bits: bit b of word c of texel (i, j) of layer l is voxel (i, j, 128 l + 32 c +
/// b).
inline std::set<Cell> cellsOf(const BinaryGrid& grid, int level = 0) {
  const gpu::TextureDescription& description = grid.stacks->description();
  const int width = std::max(description.width >> level, 1),
            height = std::max(description.height >> level, 1);
  const std::vector<std::byte> bytes = grid.stacks->download(level);
  REQUIRE(bytes.size() == 16u * static_cast<std::size_t>(width * height * description.depth));
  std::set<Cell> cells;
  for (std::size_t word = 0; word < bytes.size() / 4; ++word) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, bytes.data() + 4 * word, 4);
    const int texel = static_cast<int>(word / 4), layer = texel / (width * height);
    for (int b = 0; b < 32; ++b)
      if (bits >> b & 1)
        cells.insert({texel % width, texel / width % height,
                      BinaryGrid::kStack * layer + 32 * static_cast<int>(word % 4) + b});
  }
  return cells;
}

/// A list with its fragments and cells.
struct Voxels {
  GridPlacement grid;
  std::vector<FragmentData> fragments;
  std::set<Cell> occupied;
};

inline Voxels voxelsOf(const VoxelFragments& list) {
  const auto words = list.count->downloadValues<std::uint32_t>();
  REQUIRE(words.at(0) <= list.capacity);
  // An indirect dispatch must cover the whole list.
  REQUIRE(std::uint64_t{words.at(1)} * words.at(2) * words.at(3) *
              static_cast<std::uint64_t>(list.workGroupSize) >=
          words.at(0));
  // With a single row of groups, no group is idle.
  const auto size = static_cast<std::uint32_t>(list.workGroupSize);
  if (words.at(2) == 1) REQUIRE(words.at(1) == std::max((words.at(0) + size - 1) / size, 1u));
  Voxels result{list.grid, fragmentsOf(list), {}};
  result.occupied = cellsOf(result.fragments);
  return result;
}

}  // namespace lumivox::test
