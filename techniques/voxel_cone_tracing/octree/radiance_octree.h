// Light in a sparse voxel octree: kinds of ports of this technique's own.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "../dense/directional_grid.h"
#include "lumivox/pipeline/port.h"
#include "lumivox/pipeline/ports.h"
#include "lumivox/toolkit/change_tracking.h"

namespace lumivox::voxel_cone_tracing {

/// A sparse voxel octree (Crassin et al. 2011, Sec. 4; thesis Gomes 2015, Sec. 3.1.1 and 4.2.2). Depth 0 is
/// the root; level l of a grid with mips is depth `depth - l`. Node n of a level has a brick of the voxels 2n
/// to 2n + 2 of that level along each axis, the last of which is its neighbour's own; or of its own voxels
/// alone.
struct VoxelOctree {
  /// Where voxels lie. As in a grid with mips, coarse voxel j around the finer ones 2j and 2j + 1. Or at the
  /// corners of nodes: coarse voxel j where finer voxel 2j is (Crassin et al. 2011). Or one to each eighth of
  /// a leaf, and at the corners of nodes means of those around (thesis).
  enum class Voxels { asGrid, atCorners, inLeaves };
  /// Of what bricks are: of their own 2 x 2 x 2 voxels, found by ranks and without nodes; or of 3 x 3 x 3,
  /// those of their neighbours at their sides too, so that reading stays within a brick (Crassin et al.
  /// 2011).
  enum class Bricks { own, published };

  GridPlacement grid;     ///< of the finest voxels
  gpu::BufferRef nodes;   ///< OctreeNode; null with bricks of their own voxels
  gpu::BufferRef bricks;  ///< OctreeBrick, by depth
  gpu::BufferRef levels;  ///< OctreeLevels
  gpu::BufferRef ranks;   ///< RankedTags; null: bricks are found from the root alone
  /// Bricks of their own voxels: RankedTags of the nodes in which reading finds something, and for each the
  /// eight bricks around it; null with those as published.
  gpu::BufferRef shown, corners;
  int depth = 0;  ///< of the leaves
  Voxels voxels = Voxels::asGrid;
  Bricks bricksAre = Bricks::published;
  /// The tree of static geometry alone, of bricks of their own voxels; null where nothing moves, or where it
  /// is not known apart.
  std::shared_ptr<const VoxelOctree> still;
  std::uint64_t brickRoom = 0;   ///< bricks that there is room for
  std::uint64_t leafRoom = 0;    ///< of them those of the finest level
  std::uint64_t recordRoom = 0;  ///< tiles of nodes, or nodes in which reading finds something
  bool needsMore = true;         ///< than the frame before
  /// Bricks of the depths 0, 0 and 1, 0 to 2 ...: what trees of 2, 4, 8 ... voxels a side take.
  std::vector<std::uint32_t> bricksDownTo;

  /// Words of `levels` before those of a depth, of one depth, and before the dispatches of a depth.
  static constexpr std::uint64_t kLevelsBegin = 3, kLevelWords = 20, kLevelGroups = 2;
  /// Numbers of threads a brick for which there are dispatches.
  static constexpr std::array<int, 6> kThreads{1, 6, 8, 9, 12, 27};
  static constexpr std::uint64_t kNodeBytes = 20, kTileBytes = 8 * kNodeBytes, kBrickBytes = 8,
                                 kCornersBytes = 8 * sizeof(std::uint32_t);
  static constexpr std::uint64_t levelsBytes(int depth) {
    return (kLevelsBegin + kLevelWords * (static_cast<std::uint64_t>(depth) + 2)) * sizeof(std::uint32_t);
  }
  /// The middle of voxel 0 of the finest level, in voxels from the corner of the grid; with `asGrid` it is so
  /// in voxels of every level.
  /// Voxels along a brick, and in it.
  int brickSide() const { return bricksAre == Bricks::own ? 2 : 3; }
  int brickVoxels() const { return brickSide() * brickSide() * brickSide(); }
  float firstVoxel() const { return voxels == Voxels::inLeaves ? 0.0f : 0.5f; }
};

/// A level's bricks, read back.
struct OctreeBrickList {
  struct Brick {
    std::uint32_t index = 0;  ///< in the pool
    glm::ivec3 place{0};      ///< of its node, in nodes of that level
  };
  std::vector<Brick> bricks;

  static OctreeBrickList of(const VoxelOctree& tree, int level) {
    const auto words = tree.levels->downloadValues<std::uint32_t>();
    const auto at =
        VoxelOctree::kLevelsBegin + VoxelOctree::kLevelWords * static_cast<std::uint64_t>(tree.depth - level);
    const std::uint32_t first = words.at(at), count = words.at(at + 1);
    const auto records = tree.bricks->downloadValues<std::array<std::uint32_t, 2>>();
    OctreeBrickList result;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const std::uint32_t place = records.at(i)[1];
      result.bricks.push_back({i, {place & 1023u, place >> 10 & 1023u, place >> 20 & 1023u}});
    }
    return result;
  }
};

/// Pre-filtered outgoing radiance in the bricks of an octree, pre-multiplied by opacity.
struct RadianceOctree {
  VoxelOctree tree;
  gpu::TextureRef radiance;  ///< the pool: a texel a voxel of a brick
  /// Of a voxel: 1, the same from all sides; or 6, by the outward normals +x, -x, +y, -y, +z and -z, each
  /// with the opacity along it, in bricks one behind the other (thesis 3.1.3).
  int faces = 1;
  int poolShift = 0;     ///< the pool has 2 to the power of this bricks of a face along x and y
  float unit = 1.0f;     ///< W/(sr m^2): keeps very bright and very dark light within half floats
  int filledLevels = 1;  ///< finest first
  /// What opacity means in coarser levels, as RadianceGrid says it.
  enum class Opacity { ofVoxel, ofFinestVoxel } opacity = Opacity::ofVoxel;
  /// What is not in one of these cells has the voxels of static geometry in `still`, which is null where that
  /// is not known.
  std::shared_ptr<const RadianceOctree> still;
  ChangedCells changed;

  glm::ivec3 texelOf(std::uint32_t brick, int face = 0) const {
    const std::uint32_t row = (1u << poolShift) - 1u;
    brick = brick * static_cast<std::uint32_t>(faces) + static_cast<std::uint32_t>(face);
    return tree.brickSide() * glm::ivec3(brick & row, brick >> poolShift & row, brick >> (2 * poolShift));
  }
  /// Of the texels of the pool: those of bricks that there are, of the levels that are filled.
  std::vector<bool> texelsInUse() const {
    const gpu::TextureDescription& pool = radiance->description();
    std::vector<bool> result(static_cast<std::size_t>(pool.width) * static_cast<std::size_t>(pool.height) *
                             static_cast<std::size_t>(pool.depth));
    const int side = tree.brickSide();
    for (int level = 0; level < filledLevels; ++level)
      for (const OctreeBrickList::Brick& brick : OctreeBrickList::of(tree, level).bricks)
        for (int face = 0; face < faces; ++face)
          for (int voxel = 0; voxel < tree.brickVoxels(); ++voxel) {
            const glm::ivec3 at = texelOf(brick.index, face) +
                                  glm::ivec3(voxel % side, voxel / side % side, voxel / (side * side));
            result.at(static_cast<std::size_t>((at.z * pool.height + at.y) * pool.width + at.x)) = true;
          }
    return result;
  }
  /// The voxels of a level, each once: those that a brick shares with the neighbour above are that one's.
  /// `component`: 3 gives the opacity, 0 the three channels of radiance.
  std::vector<VoxelsRead::Voxel> voxels(int level, int component, int face = 0) const {
    const std::vector<float> texels = radiance->downloadFloats(0);
    const gpu::TextureDescription& pool = radiance->description();
    std::vector<VoxelsRead::Voxel> result;
    for (const OctreeBrickList::Brick& brick : OctreeBrickList::of(tree, level).bricks)
      for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 local(corner & 1, corner >> 1 & 1, corner >> 2),
            at = texelOf(brick.index, face) + local;
        const float* texel =
            texels.data() + 4 * static_cast<std::size_t>((at.z * pool.height + at.y) * pool.width + at.x);
        const glm::vec3 value =
            component == 3 ? glm::vec3(texel[3]) : unit * glm::vec3(texel[0], texel[1], texel[2]);
        if (texel[3] > 0.0f) result.push_back({2 * brick.place + local, value});
      }
    return result;
  }
  /// Of voxels with six faces: the opacities along x, y and z of those that have one.
  std::vector<VoxelsRead::Voxel> opacities(int level) const {
    std::map<std::array<int, 3>, glm::vec3> found;
    for (int axis = 0; axis < 3; ++axis)
      for (const auto& [voxel, value] : voxels(level, 3, 2 * axis))
        found[{voxel.x, voxel.y, voxel.z}][axis] = value.x;
    std::vector<VoxelsRead::Voxel> result;
    for (const auto& [at, value] : found) result.push_back({{at[0], at[1], at[2]}, value});
    return result;
  }
};

}  // namespace lumivox::voxel_cone_tracing

namespace lumivox {

template <>
struct PortTraits<voxel_cone_tracing::VoxelOctree> {
  static PortKind kind() {
    return {
        "VoxelOctree",
        "the nodes of a sparse voxel octree",
        {{"nodes", "buffer", "array of OctreeNode in shaders/voxel_cone_tracing/octree/octree.glsl; or null"},
         {"bricks", "buffer", "array of OctreeBrick: the node of each brick and where it lies"},
         {"levels", "buffer", "bricks, tiles and leaves wanted; for each depth its bricks and dispatches"},
         {"ranks", "buffer", "a bit for each node that could be, beside the number of those before; or null"},
         {"shown", "buffer", "the same for nodes in which reading between voxels finds something; or null"},
         {"corners", "buffer", "the eight bricks around each of those; or null"}}};
  }
  static void contents(const voxel_cone_tracing::VoxelOctree& port, PortContents& contents) {
    contents.buffer("nodes", port.nodes);
    contents.buffer("bricks", port.bricks);
    contents.buffer("levels", port.levels);
    contents.buffer("ranks", port.ranks);
    contents.buffer("shown", port.shown);
    contents.buffer("corners", port.corners);
  }
};

template <>
struct PortTraits<voxel_cone_tracing::RadianceOctree> {
  static PortKind kind() {
    PortKind result = PortTraits<voxel_cone_tracing::VoxelOctree>::kind();
    result.name = "RadianceOctree";
    result.meaning = "outgoing radiance and opacity in the bricks of a sparse voxel octree";
    result.resources.push_back(
        {"radiance", "d3 rgba16f or rgba32f",
         "2 x 2 x 2 or 3 x 3 x 3 texels a brick, for each of one or six faces: rgb radiance * opacity / unit, a opacity"});
    result.conditions = {radianceUnitCondition()};
    result.fields = {{"radiance", "outgoing radiance, multiplied by the opacity", "W/(sr m^2)"},
                     {"opacity", "opacity", "1", PortField::Role::fog}};
    for (const char* face : PortTraits<voxel_cone_tracing::DirectionalRadianceGrid>::kFaces)
      result.fields.push_back({std::string("radiance_") + face,
                               "outgoing radiance of the face with that normal, multiplied by the opacity",
                               "W/(sr m^2)"});
    result.fields.push_back({"opacity_along", "opacity along x, y and z, of voxels with six faces", "1"});
    return result;
  }
  static void contents(const voxel_cone_tracing::RadianceOctree& port, PortContents& contents) {
    PortTraits<voxel_cone_tracing::VoxelOctree>::contents(port.tree, contents);
    contents.texture("radiance", port.radiance, {.texels = [port] { return port.texelsInUse(); }});
    for (int level = 0; level < port.filledLevels; ++level) {
      const double size = static_cast<double>(port.tree.grid.voxelSize) * (1 << level);
      const bool asGrid = port.tree.voxels == voxel_cone_tracing::VoxelOctree::Voxels::asGrid;
      const double middle =
          asGrid ? 0.5 * size : port.tree.firstVoxel() * static_cast<double>(port.tree.grid.voxelSize);
      const VoxelBox box{glm::dvec3(port.tree.grid.low) + middle - 0.5 * size, glm::dvec3(size),
                         glm::ivec3(2 << (port.tree.depth - level))};
      const std::uint64_t bytes = port.radiance->sizeBytes();
      if (port.faces > 1) {
        sides(port, level, box, contents);
        continue;
      }
      contents.field("radiance", box, VoxelsRead{3, bytes, [port, level] { return port.voxels(level, 0); }},
                     level);
      contents.field("opacity", box, VoxelsRead{1, bytes, [port, level] { return port.voxels(level, 3); }},
                     level);
    }
  }
  static void sides(const voxel_cone_tracing::RadianceOctree& port, int level, const VoxelBox& box,
                    PortContents& contents) {
    const std::uint64_t bytes = port.radiance->sizeBytes();
    int face = 0;
    for (const char* side : PortTraits<voxel_cone_tracing::DirectionalRadianceGrid>::kFaces) {
      contents.field(std::string("radiance_") + side, box,
                     VoxelsRead{3, bytes, [port, level, face] { return port.voxels(level, 0, face); }},
                     level);
      ++face;
    }
    contents.field("opacity_along", box,
                   VoxelsRead{3, bytes, [port, level] { return port.opacities(level); }}, level);
  }
};

}  // namespace lumivox
