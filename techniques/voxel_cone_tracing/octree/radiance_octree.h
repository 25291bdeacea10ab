// Light in a sparse voxel octree: kinds of ports of this technique's own.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "lumivox/pipeline/port.h"
#include "lumivox/pipeline/ports.h"
#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "lumivox/toolkit/change_tracking.h"

namespace lumivox::voxel_cone_tracing {

/// A sparse voxel octree (Crassin et al. 2011, Sec. 4; thesis Gomes 2015, Sec. 3.1.1). Depth 0 is the root;
/// level l of a grid with mips is depth `depth - l`. Voxels lie as in such a grid, coarse voxel j around the
/// finer ones 2j and 2j + 1, and node n of a level has a brick of its voxels 2n and 2n + 1 along each axis.
struct VoxelOctree {
  GridPlacement grid;     ///< of the finest voxels
  gpu::BufferRef bricks;  ///< the place of each brick's node, by depth
  gpu::BufferRef levels;  ///< OctreeLevels
  gpu::BufferRef ranks;   ///< RankedTags: locate the bricks
  /// RankedTags of the nodes in which reads find something, and the eight bricks around each of them.
  gpu::BufferRef shown, corners;
  int depth = 0;  ///< of the leaves
  /// The tree of static geometry only; null where nothing moves or static geometry is not told apart.
  std::shared_ptr<const VoxelOctree> still;
  std::uint64_t brickRoom = 0;  ///< bricks with room
  std::uint64_t leafRoom = 0;   ///< those of them of the finest level
  std::uint64_t shownRoom = 0;  ///< nodes in which reads find something
  bool needsMore = true;        ///< whether it needs more room than the frame before
  /// Bricks of the depths 0, 0 to 1, 0 to 2 ...: those of trees of 2, 4, 8 ... voxels along a side.
  std::vector<std::uint32_t> bricksDownTo;

  /// Layout of `levels` in words: those before all depths, those of one depth, and those before a depth's
  /// dispatches.
  static constexpr std::uint64_t kLevelsBegin = 3, kLevelWords = 8, kLevelGroups = 2;
  /// Numbers of threads a brick for which there are dispatches.
  static constexpr std::array<int, 2> kThreads{1, 8};
  static constexpr int kBrickSide = 2, kBrickVoxels = 8;  ///< voxels along a brick, and in it
  static constexpr std::uint64_t kBrickBytes = sizeof(std::uint32_t),
                                 kCornersBytes = 8 * sizeof(std::uint32_t);
  static constexpr std::uint64_t levelsBytes(int depth) {
    return (kLevelsBegin + kLevelWords * (static_cast<std::uint64_t>(depth) + 2)) * sizeof(std::uint32_t);
  }
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
    const auto places = tree.bricks->downloadValues<std::uint32_t>();
    OctreeBrickList result;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const std::uint32_t place = places.at(i);
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
  /// Meaning of opacity in coarser levels, as in RadianceGrid.
  enum class Opacity { ofVoxel, ofFinestVoxel } opacity = Opacity::ofVoxel;
  /// Outside these cells the voxels are those of static geometry in `still`, which is null where that is
  /// unknown.
  std::shared_ptr<const RadianceOctree> still;
  ChangedCells changed;

  glm::ivec3 texelOf(std::uint32_t brick, int face = 0) const {
    const std::uint32_t row = (1u << poolShift) - 1u;
    brick = brick * static_cast<std::uint32_t>(faces) + static_cast<std::uint32_t>(face);
    return VoxelOctree::kBrickSide *
           glm::ivec3(brick & row, brick >> poolShift & row, brick >> (2 * poolShift));
  }
  /// Which texels of the pool belong to bricks of filled levels.
  std::vector<bool> texelsInUse() const {
    const gpu::TextureDescription& pool = radiance->description();
    std::vector<bool> result(static_cast<std::size_t>(pool.width) * static_cast<std::size_t>(pool.height) *
                             static_cast<std::size_t>(pool.depth));
    for (int level = 0; level < filledLevels; ++level)
      for (const OctreeBrickList::Brick& brick : OctreeBrickList::of(tree, level).bricks)
        for (int face = 0; face < faces; ++face)
          for (int voxel = 0; voxel < VoxelOctree::kBrickVoxels; ++voxel) {
            const glm::ivec3 at =
                texelOf(brick.index, face) + glm::ivec3(voxel & 1, voxel >> 1 & 1, voxel >> 2);
            result.at(static_cast<std::size_t>((at.z * pool.height + at.y) * pool.width + at.x)) = true;
          }
    return result;
  }
  /// The occupied voxels of a level. `component`: 3 gives the opacity, 0 the three channels of radiance.
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
  /// For voxels with six faces, the opacities along x, y and z of those that have one.
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
    return {"VoxelOctree",
            "the nodes of a sparse voxel octree",
            {{"bricks", "buffer", "of each brick the place of its node, 10 bits an axis"},
             {"levels", "buffer",
              "bricks, shown nodes and leaves wanted; for each depth its bricks and dispatches"},
             {"ranks", "buffer", "a bit for each node that could be, beside the number of those before"},
             {"shown", "buffer", "the same for nodes in which reading between voxels finds something"},
             {"corners", "buffer", "the eight bricks around each of those"}}};
  }
  static void contents(const voxel_cone_tracing::VoxelOctree& port, PortContents& contents) {
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
         "2 x 2 x 2 texels a brick, for each of one or six faces: rgb radiance * opacity / unit, a opacity"});
    result.conditions = {radianceUnitCondition()};
    result.fields = {{"radiance", "outgoing radiance, multiplied by the opacity", "W/(sr m^2)"},
                     {"opacity", "opacity", "1", PortField::Role::fog}};
    for (const char* face : PortTraits<DirectionalRadianceGrid>::kFaces)
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
      const VoxelBox box{glm::dvec3(port.tree.grid.low), glm::dvec3(size),
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
    for (const char* side : PortTraits<DirectionalRadianceGrid>::kFaces) {
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
