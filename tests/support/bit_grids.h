// Grids of bits, made from sets of voxels.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "lumivox/measure/voxels.h"
#include "lumivox/pipeline/ports.h"
#include "support/techniques.h"

namespace lumivox::test {

/// A grid of 1 m voxels that starts at the origin, so that metres are voxels.
inline BinaryGrid gridOf(const VoxelSet& set) {
  const glm::ivec3 size = set.resolution();
  const int layers = (size.z + BinaryGrid::kStack - 1) / BinaryGrid::kStack;
  BinaryGrid result{{glm::vec3(0.0f), 1.0f, size}, nullptr};
  const int levels = gpu::fullLevelCount(size.x, size.y, 1);
  result.stacks =
      std::make_shared<gpu::Texture>(device(),
                                     gpu::TextureDescription{gpu::TextureKind::d2Array, gpu::Format::rgba32ui,
                                                             size.x, size.y, layers, levels},
                                     "test bits");
  for (int level = 0; level < levels; ++level) {
    const glm::ivec2 texels = glm::max(glm::ivec2(size) >> level, 1);
    std::vector<std::uint32_t> words(static_cast<std::size_t>(texels.x) * static_cast<std::size_t>(texels.y) *
                                     static_cast<std::size_t>(layers) * 4);
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
          if (!set.contains({x, y, z})) continue;
          const glm::ivec2 texel = glm::min(glm::ivec2(x, y) >> level, texels - 1);
          words[4 *
                    (static_cast<std::size_t>(z / 128) * static_cast<std::size_t>(texels.y) +
                     static_cast<std::size_t>(texel.y)) *
                    static_cast<std::size_t>(texels.x) +
                4 * static_cast<std::size_t>(texel.x) + static_cast<std::size_t>(z % 128 / 32)] |=
              1u << (z % 32);
        }
    result.stacks->upload(level, std::as_bytes(std::span(words)));
  }
  return result;
}

}  // namespace lumivox::test
