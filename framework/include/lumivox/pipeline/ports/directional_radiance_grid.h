// Radiance that depends on the side from which a voxel is seen.
#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "lumivox/pipeline/ports/radiance_grid.h"

namespace lumivox {

/// Pre-filtered outgoing radiance of the six faces of each voxel, pre-multiplied by the opacity along the
/// face's normal, one mip per halving (Crassin et al. 2011, Sec. 8.1; thesis Gomes 2015, Sec. 3.1.3 and
/// 4.2.1, Fig. 64).
struct DirectionalRadianceGrid {
  GridPlacement grid;
  /// The voxels of the finest level, which are the same from all sides; null where they have faces too.
  gpu::TextureRef finest;
  /// By the outward normals +x, -x, +y, -y, +z and -z. Their first level is the finest of the grid, or the
  /// next one where there is `finest`.
  std::array<gpu::TextureRef, 6> faces;
  float unit = 1.0f;        ///< W/(sr m^2): keeps very bright and very dark light within half floats
  int filledLevels = 1;     ///< levels of the grid that hold values, finest first
  bool holdsMedia = false;  ///< participating media are in the voxels beside the surfaces
  /// Outside of these bricks the finest level is 0; null members: not known.
  OccupiedBricks occupied;
  ChangedBricks changed;

  /// Level of the grid that the first level of `faces` is.
  int firstLevelOfFaces() const { return finest != nullptr ? 1 : 0; }
};

template <>
struct PortTraits<DirectionalRadianceGrid> {
  static constexpr std::array kFaces = {"positive_x", "negative_x", "positive_y",
                                        "negative_y", "positive_z", "negative_z"};
  static PortKind kind() {
    PortKind result{
        "DirectionalRadianceGrid",
        "outgoing radiance and opacity of the six faces of each voxel, one mip per halving",
        {{"finest", "d3 rgba16f or rgba32f",
          "rgb radiance * opacity / unit, a opacity, from all sides; or null"},
         {"bricks", "buffer", "i, j, k of each occupied brick of 4 x 4 x 4, in 10 bits each; or null"},
         {"count", "buffer", "how many; then indirect dispatches over their voxels; or null"}},
        {{"opacity", "opacity along x, y and z", "1"}},
        {},
        {radianceUnitCondition()}};
    for (const char* face : kFaces) {
      result.resources.push_back({face, "d3 rgba16f or rgba32f with mips",
                                  "rgb radiance * opacity / unit, a opacity, as seen from that side"});
      result.fields.push_back({std::string("radiance_") + face,
                               "outgoing radiance of the face with that normal, multiplied by the opacity",
                               "W/(sr m^2)"});
    }
    return result;
  }
  static void contents(const DirectionalRadianceGrid& port, PortContents& contents) {
    contents.texture("finest", port.finest);
    contents.buffer("bricks", port.occupied.bricks);
    contents.buffer("count", port.occupied.count);
    const int filledOfFaces = std::max(0, port.filledLevels - port.firstLevelOfFaces());
    for (std::size_t face = 0; face < kFaces.size(); ++face)
      contents.texture(kFaces[face], port.faces[face], {.levels = filledOfFaces});
    for (int level = 0; level < port.filledLevels; ++level) {
      const VoxelBox box = VoxelBox::of(port.grid, levelResolution(port.grid.resolution, level));
      const bool fromFinest = level < port.firstLevelOfFaces();
      const int levelOfTexture = fromFinest ? level : level - port.firstLevelOfFaces();
      const auto texture = [&](std::size_t face) { return fromFinest ? port.finest : port.faces[face]; };
      for (std::size_t face = 0; face < kFaces.size(); ++face)
        contents.field(std::string("radiance_") + kFaces[face], box,
                       VoxelTexels{{texture(face)}, {{0, 0}, {0, 1}, {0, 2}}, levelOfTexture, port.unit},
                       level);
      contents.field(
          "opacity", box,
          VoxelTexels{{texture(0), texture(2), texture(4)}, {{0, 3}, {1, 3}, {2, 3}}, levelOfTexture}, level);
    }
  }
};

}  // namespace lumivox
