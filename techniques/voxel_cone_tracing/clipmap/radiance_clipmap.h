// Light in a clipmap, and the placement of its levels: a kind of port of this technique's own.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/pipeline/port.h"

namespace lumivox::voxel_cone_tracing {

/// Voxels from `first` on and before `end`; empty where an end is not above.
struct VoxelRange {
  glm::ivec3 first{0}, end{0};
  glm::ivec3 size() const { return glm::max(end - first, glm::ivec3(0)); }
  bool empty() const { return size().x == 0 || size().y == 0 || size().z == 0; }
  bool contains(const glm::ivec3& voxel) const {
    return glm::all(glm::greaterThanEqual(voxel, first)) && glm::all(glm::lessThan(voxel, end));
  }
  VoxelRange within(const VoxelRange& other) const {
    return {glm::max(first, other.first), glm::min(end, other.end)};
  }
  /// The smallest range that contains both.
  VoxelRange around(const VoxelRange& other) const {
    if (empty()) return other;
    return other.empty() ? *this : VoxelRange{glm::min(first, other.first), glm::max(end, other.end)};
  }
  bool operator==(const VoxelRange&) const = default;

  /// Address of a voxel in a level of `period` voxels: frac(world / size) of thesis Sec. 3.5.1, in voxels.
  static glm::ivec3 addressOf(const glm::ivec3& voxel, int period) {
    return ((voxel % period) + period) % period;
  }
  /// The part of this range outside `other`, as at most six disjoint boxes: the slabs that a level uncovers
  /// when it moves on from `other`.
  std::vector<VoxelRange> without(const VoxelRange& other) const {
    if (empty()) return {};
    const VoxelRange common = within(other);
    if (common.empty()) return {*this};
    std::vector<VoxelRange> result;
    VoxelRange rest = *this;
    for (int axis = 0; axis < 3; ++axis) {
      VoxelRange below = rest, above = rest;
      below.end[axis] = rest.first[axis] = common.first[axis];
      above.first[axis] = rest.end[axis] = common.end[axis];
      for (const VoxelRange& slab : {below, above})
        if (!slab.empty()) result.push_back(slab);
    }
    return result;
  }
};

/// Pre-filtered outgoing radiance of the six faces of voxels in levels of equal size around the camera, each
/// twice as coarse as the one before (thesis Gomes 2015, Sec. 3.5; Tanner et al. 1998), pre-multiplied by
/// opacity, and in the levels above the coarsest of them that halving makes. Voxel (i,j,k) of level l covers
/// origin + [i,i+1] x [j,j+1] x [k,k+1] times voxelSize 2^l, wherever the camera is, and i, j and k may be
/// below 0.
struct RadianceClipmap {
  /// Voxels of a level in the volumes. Addresses repeat with a period; a border of one texel around each
  /// block copies the voxels of the opposite side.
  struct Block {
    VoxelRange voxels;
    glm::ivec3 texel{0};     ///< of the address (0,0,0)
    int period = 1;          ///< voxels along each axis with room
    std::uint32_t word = 0;  ///< first word of its bits in `occupied`
    glm::ivec3 texelOf(const glm::ivec3& voxel) const { return texel + VoxelRange::addressOf(voxel, period); }
  };
  struct Level {
    Block own;    ///< as voxelized; for levels above those around the camera, from the finer one
    Block inner;  ///< the part inside the finer level, blended with the finer one's mean; empty: none
    /// Range where the level is read, in voxels; unbounded on the sides where the store ends.
    glm::vec3 reachFirst{0.0f}, reachEnd{0.0f};
  };
  static constexpr float kEndless = 1e30f;

  glm::vec3 origin{0.0f};     ///< m
  float voxelSize = 1.0f;     ///< of the finest level, m
  int around = 1;             ///< levels around the camera
  std::vector<Level> levels;  ///< finest first
  float ramp = 0.0f;          ///< voxels over which a level blends into the finer one's mean
  float border = 1.0f;        ///< voxels of a level over which reading blends into the next one
  int filledLevels = 1;       ///< finest first
  float unit = 1.0f;          ///< W/(sr m^2): keeps very bright and very dark light within half floats
  /// By the outward normals +x, -x, +y, -y, +z and -z.
  std::array<gpu::TextureRef, 6> faces;
  gpu::BufferRef occupied;  ///< a bit for each voxel of each block

  /// Changes in these volumes by the last filling of levels; the one before has a number one less.
  struct Change {
    std::uint64_t number = 0;
    bool all = true;
    std::vector<VoxelRange> voxelized;  ///< by level; empty: nothing
    std::vector<Level> before;          ///< the levels then; empty where `all`
    /// Among voxels that stayed in the levels, the cells of 4 x 4 x 4 voxels with a difference
    /// (clipmap_cells.glsl); null: as `voxelized`.
    gpu::BufferRef cells;
  };
  Change change;

  float sizeOf(int level) const { return voxelSize * static_cast<float>(1 << level); }
  /// Whether all filled levels, and `inner`, may be read.
  bool filtered() const { return filledLevels == static_cast<int>(levels.size()); }

  /// The occupied voxels of a level, each once, with the value that cones read; numbers count from the
  /// level's first voxel. `face`: by outward normals; 6: the opacity along x, y and z.
  std::vector<VoxelsRead::Voxel> voxels(int index, int face) const {
    const Level& level = levels[static_cast<std::size_t>(index)];
    const bool opacities = face == 6;
    std::array<std::vector<float>, 3> texels;
    for (std::size_t i = 0; i < (opacities ? 3 : 1); ++i)
      texels[i] = faces[opacities ? 2 * i : static_cast<std::size_t>(face)]->downloadFloats(0);
    const gpu::TextureDescription& volume = faces[0]->description();
    std::vector<VoxelsRead::Voxel> result;
    const glm::ivec3 size = level.own.voxels.size();
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
          const glm::ivec3 voxel = level.own.voxels.first + glm::ivec3(x, y, z);
          const Block& block = filtered() && level.inner.voxels.contains(voxel) ? level.inner : level.own;
          const glm::ivec3 at = block.texelOf(voxel);
          const std::size_t texel =
              4 * static_cast<std::size_t>((at.z * volume.height + at.y) * volume.width + at.x);
          if (opacities) {
            const glm::vec3 value(texels[0][texel + 3], texels[1][texel + 3], texels[2][texel + 3]);
            if (value != glm::vec3(0.0f)) result.push_back({{x, y, z}, value});
          } else if (texels[0][texel + 3] > 0.0f) {
            result.push_back(
                {{x, y, z}, unit * glm::vec3(texels[0][texel], texels[0][texel + 1], texels[0][texel + 2])});
          }
        }
    return result;
  }
};

}  // namespace lumivox::voxel_cone_tracing

namespace lumivox {

template <>
struct PortTraits<voxel_cone_tracing::RadianceClipmap> {
  static constexpr std::array kFaces = {"positive_x", "negative_x", "positive_y",
                                        "negative_y", "positive_z", "negative_z"};
  static PortKind kind() {
    PortKind result{"RadianceClipmap",
                    "outgoing radiance and opacity of the six faces of voxels in levels around the camera",
                    {{"occupied", "buffer", "a bit for each voxel that is not empty, block after block"}},
                    {{"opacity", "opacity along x, y and z", "1"}},
                    {},
                    {radianceUnitCondition()}};
    for (const char* face : kFaces) {
      result.resources.push_back(
          {face, "d3 rgba16f or rgba32f",
           "blocks of voxels: rgb radiance * opacity / unit, a opacity, as seen from that side"});
      result.fields.push_back({std::string("radiance_") + face,
                               "outgoing radiance of the face with that normal, multiplied by the opacity",
                               "W/(sr m^2)"});
    }
    return result;
  }
  static void contents(const voxel_cone_tracing::RadianceClipmap& port, PortContents& contents) {
    contents.buffer("occupied", port.occupied);
    for (std::size_t face = 0; face < kFaces.size(); ++face) contents.texture(kFaces[face], port.faces[face]);
    for (int level = 0; level < port.filledLevels; ++level) {
      const VoxelRange& voxels = port.levels[static_cast<std::size_t>(level)].own.voxels;
      const auto size = static_cast<double>(port.sizeOf(level));
      const VoxelBox box{glm::dvec3(port.origin) + size * glm::dvec3(voxels.first), glm::dvec3(size),
                         voxels.size()};
      const std::uint64_t bytes = port.faces[0]->sizeBytes();
      for (int face = 0; face < 6; ++face)
        contents.field(std::string("radiance_") + kFaces[static_cast<std::size_t>(face)], box,
                       VoxelsRead{3, bytes, [port, level, face] { return port.voxels(level, face); }}, level);
      contents.field("opacity", box,
                     VoxelsRead{3, 3 * bytes, [port, level] { return port.voxels(level, 6); }}, level);
    }
  }

 private:
  using VoxelRange = voxel_cone_tracing::VoxelRange;
};

}  // namespace lumivox
