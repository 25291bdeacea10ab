// Voxel fragments with given contents, in a list whose voxels are half as wide as the cells of light
// propagation.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "support/techniques.h"
#include "support/voxel_fragments.h"

namespace lumivox::test {

/// A unit vector in octahedral encoding, as by `packNormal` in shaders/common/voxel.glsl.
inline std::uint32_t packedOctahedron(const glm::vec3& normal) {
  glm::vec2 p = glm::vec2(normal) / (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  if (normal.z < 0.0f)
    p = (1.0f - glm::abs(glm::vec2(p.y, p.x))) *
        glm::vec2(p.x >= 0.0f ? 1.0f : -1.0f, p.y >= 0.0f ? 1.0f : -1.0f);
  return glm::packSnorm2x16(p);
}

/// A fragment of a square half a cell wide. `place`: in cells.
inline FragmentData squareAt(const glm::dvec3& place, const glm::vec3& normal,
                             const glm::vec3& albedo = glm::vec3(0.5f), float coverage = 1.0f) {
  const glm::ivec3 voxel(glm::floor(2.0 * place));
  const glm::ivec3 offset(glm::round((2.0 * place - glm::dvec3(voxel)) * 1023.0));
  FragmentData result{};
  result.voxel = static_cast<std::uint32_t>(voxel.x | voxel.y << 10 | voxel.z << 20);
  result.offset = static_cast<std::uint32_t>(offset.x | offset.y << 10 | offset.z << 20);
  result.normal = packedOctahedron(glm::normalize(normal));
  result.albedoRg = glm::packHalf2x16(glm::vec2(albedo));
  result.albedoBCoverage = glm::packHalf2x16(glm::vec2(albedo.z, coverage));
  return result;
}

/// The list of these squares over a grid of cells.
inline VoxelFragments listOver(const GridPlacement& cells, const std::vector<FragmentData>& fragments) {
  VoxelFragments list;
  list.grid = {cells.low, 0.5f * cells.voxelSize, 2 * cells.resolution};
  list.capacity = fragments.size() + 1;
  list.fragments = std::make_shared<gpu::Buffer>(device(), list.capacity * sizeof(FragmentData), "list");
  list.fragments->uploadValues(std::span<const FragmentData>(fragments));
  const auto count = static_cast<std::uint32_t>(fragments.size());
  // At most two groups per row, so that longer lists already use several rows.
  const std::uint32_t groups = std::max(1u, (count + 63) / 64), row = std::min(groups, 2u);
  const std::array<std::uint32_t, 4> words{count, row, (groups + row - 1) / row, 1};
  list.count = std::make_shared<gpu::Buffer>(device(), sizeof(words), "count");
  list.count->uploadValues(std::span<const std::uint32_t>(words));
  return list;
}

}  // namespace lumivox::test
