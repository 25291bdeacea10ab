// A sparse voxel octree as printed (thesis Gomes 2015, Sec. 3.1.1 and 4.2.2; Crassin et al. 2011, Sec. 4):
// kinds of ports of this technique's own.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "lumivox/pipeline/ports.h"

namespace lumivox::thesis_cone_tracing {

/// The nodes of an octree. Depth 0 is the root; level l of a grid with mips is depth `depth - l`. Node n of a
/// level has a brick of the voxels 2n to 2n + 2 of that level along each axis, the last of which is its
/// neighbour's own.
struct OctreeNodes {
  /// Where voxels lie: one to each eighth of a leaf, and at the corners of nodes means of those around
  /// (thesis); or at the corners of nodes, coarse voxel j where finer voxel 2j is (Crassin et al. 2011).
  enum class Voxels { inLeaves, atCorners };

  GridPlacement grid;     ///< of the finest voxels
  gpu::BufferRef nodes;   ///< OctreeNode
  gpu::BufferRef bricks;  ///< OctreeBrick, by depth
  gpu::BufferRef levels;  ///< OctreeLevels
  int depth = 0;          ///< of the leaves
  Voxels voxels = Voxels::inLeaves;
  std::uint64_t brickRoom = 0;  ///< bricks with room
  std::uint64_t leafRoom = 0;   ///< those of them of the finest level

  /// Layout of `levels` in words: those before all depths, those of one depth, and those before a depth's
  /// dispatches.
  static constexpr std::uint64_t kLevelsBegin = 3, kLevelWords = 20, kLevelGroups = 2;
  /// Numbers of threads a brick for which there are dispatches.
  static constexpr std::array<int, 6> kThreads{1, 6, 8, 9, 12, 27};
  static constexpr int kBrickSide = 3, kBrickVoxels = 27;  ///< voxels along a brick, and in it
  static constexpr std::uint64_t kNodeBytes = 20, kTileBytes = 8 * kNodeBytes, kBrickBytes = 8;
  /// Index in `levels` of a depth's first word.
  static constexpr std::uint64_t levelWord(int depth) {
    return kLevelsBegin + kLevelWords * static_cast<std::uint64_t>(depth);
  }
  /// Middle of voxel 0 of every level, in finest voxels from the grid's corner.
  float firstVoxel() const { return voxels == Voxels::inLeaves ? 0.0f : 0.5f; }

  /// A brick, read back.
  struct Brick {
    std::uint32_t index = 0;  ///< in the pool
    glm::ivec3 place{0};      ///< of its node, in nodes of its level
  };
  std::vector<Brick> bricksOf(int level) const {
    const auto words = levels->downloadValues<std::uint32_t>();
    const std::uint64_t at = levelWord(depth - level);
    const std::uint32_t first = words.at(at), count = words.at(at + 1);
    const auto records = bricks->downloadValues<std::array<std::uint32_t, 2>>();
    std::vector<Brick> result;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const std::uint32_t place = records.at(i)[1];
      result.push_back({i, {place & 1023u, place >> 10 & 1023u, place >> 20 & 1023u}});
    }
    return result;
  }
};

/// Outgoing radiance in the bricks of an octree, pre-multiplied by opacity.
struct OctreeBricks {
  OctreeNodes tree;
  gpu::TextureRef radiance;  ///< the pool: 3 x 3 x 3 texels a brick, rgba32f
  int poolShift = 0;         ///< the pool has 2 to the power of this bricks along x and y
  int filledLevels = 1;      ///< finest first

  glm::ivec3 texelOf(std::uint32_t brick) const {
    const std::uint32_t row = (1u << poolShift) - 1u;
    return OctreeNodes::kBrickSide *
           glm::ivec3(brick & row, brick >> poolShift & row, brick >> (2 * poolShift));
  }
  glm::ivec3 poolSize() const {
    const gpu::TextureDescription& pool = radiance->description();
    return {pool.width, pool.height, pool.depth};
  }
  /// Which texels of the pool belong to bricks of filled levels.
  std::vector<bool> texelsInUse() const {
    const glm::ivec3 size = poolSize();
    std::vector<bool> result(GridPlacement{.resolution = size}.voxelCount());
    constexpr int kSide = OctreeNodes::kBrickSide;
    for (int level = 0; level < filledLevels; ++level)
      for (const OctreeNodes::Brick& brick : tree.bricksOf(level))
        for (int voxel = 0; voxel < OctreeNodes::kBrickVoxels; ++voxel) {
          const glm::ivec3 at = texelOf(brick.index) +
                                glm::ivec3(voxel % kSide, voxel / kSide % kSide, voxel / (kSide * kSide));
          result.at(static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x)) = true;
        }
    return result;
  }
  /// The voxels of a level, each once; a voxel shared with the neighbour above belongs to that one.
  /// `component`: 3 gives the opacity, 0 the three channels of radiance.
  std::vector<VoxelsRead::Voxel> voxels(int level, int component) const {
    const std::vector<float> texels = radiance->downloadFloats(0);
    const glm::ivec3 size = poolSize();
    std::vector<VoxelsRead::Voxel> result;
    for (const OctreeNodes::Brick& brick : tree.bricksOf(level))
      for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 local(corner & 1, corner >> 1 & 1, corner >> 2), at = texelOf(brick.index) + local;
        const float* texel =
            texels.data() + 4 * static_cast<std::size_t>((at.z * size.y + at.y) * size.x + at.x);
        const glm::vec3 value =
            component == 3 ? glm::vec3(texel[3]) : glm::vec3(texel[0], texel[1], texel[2]);
        if (texel[3] > 0.0f) result.push_back({2 * brick.place + local, value});
      }
    return result;
  }
};

}  // namespace lumivox::thesis_cone_tracing

namespace lumivox {

template <>
struct PortTraits<thesis_cone_tracing::OctreeNodes> {
  static PortKind kind() {
    return {
        "OctreeNodes",
        "the nodes of a sparse voxel octree as printed",
        {{"nodes", "buffer", "array of OctreeNode in shaders/thesis_cone_tracing/octree.glsl"},
         {"bricks", "buffer", "array of OctreeBrick: the node of each brick and where it lies"},
         {"levels", "buffer", "bricks, tiles and leaves wanted; for each depth its bricks and dispatches"}}};
  }
  static void contents(const thesis_cone_tracing::OctreeNodes& port, PortContents& contents) {
    contents.buffer("nodes", port.nodes);
    contents.buffer("bricks", port.bricks);
    contents.buffer("levels", port.levels);
  }
};

template <>
struct PortTraits<thesis_cone_tracing::OctreeBricks> {
  static PortKind kind() {
    PortKind result = PortTraits<thesis_cone_tracing::OctreeNodes>::kind();
    result.name = "OctreeBricks";
    result.meaning = "outgoing radiance and opacity in the bricks of a sparse voxel octree as printed";
    result.resources.push_back(
        {"radiance", "d3 rgba32f", "3 x 3 x 3 texels a brick: rgb radiance * opacity, a opacity"});
    result.fields = {{"radiance", "outgoing radiance, multiplied by the opacity", "W/(sr m^2)"},
                     {"opacity", "opacity", "1", PortField::Role::fog}};
    return result;
  }
  static void contents(const thesis_cone_tracing::OctreeBricks& port, PortContents& contents) {
    PortTraits<thesis_cone_tracing::OctreeNodes>::contents(port.tree, contents);
    contents.texture("radiance", port.radiance, {.texels = [port] { return port.texelsInUse(); }});
    for (int level = 0; level < port.filledLevels; ++level) {
      const auto finest = static_cast<double>(port.tree.grid.voxelSize);
      const double size = finest * (1 << level), middle = port.tree.firstVoxel() * finest;
      const VoxelBox box{glm::dvec3(port.tree.grid.low) + middle - 0.5 * size, glm::dvec3(size),
                         glm::ivec3(2 << (port.tree.depth - level))};
      const std::uint64_t bytes = port.radiance->sizeBytes();
      contents.field("radiance", box, VoxelsRead{3, bytes, [port, level] { return port.voxels(level, 0); }},
                     level);
      contents.field("opacity", box, VoxelsRead{1, bytes, [port, level] { return port.voxels(level, 3); }},
                     level);
    }
  }
};

}  // namespace lumivox
