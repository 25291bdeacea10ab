// Knowledge of the surfaces in the cells of light propagation: a kind of port of this technique's own.
#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox::light_propagation_volumes {

/// The faces between cells that surfaces occlude, in the nested grids of an ShGrid.
struct OccludedFaces {
  struct Level {
    GridPlacement grid;  ///< of the cells
    gpu::TextureRef occluded;
    gpu::TextureRef moved;
    gpu::BufferRef packed;
  };
  std::vector<Level> levels;  ///< finest and smallest first
};

}  // namespace lumivox::light_propagation_volumes

namespace lumivox {

template <>
struct PortTraits<light_propagation_volumes::OccludedFaces> {
  static PortKind kind() {
    return {
        "OccludedFaces",
        "the faces between the cells of an ShGrid that surfaces occlude",
        {{"occluded", "d3 rgba8, for each level, one voxel larger",
          "xyz the shares of the faces to the voxels at lower x, y and z that surfaces occlude; or null"},
         {"moved", "d3 rgba8, for each level, one voxel larger",
          "of the same faces, as bytes: how far surfaces were moved to lie on them, fourteenths of a voxel: the low four bits of those that look down the axis and truly lie above, the high ones the other way; or null"},
         {"packed", "buffer, for each level",
          "five words a voxel, x first (thesis Gomes 2015, Listings 4.26 to 4.29): albedo over pi behind its contrast, and for each face of a tetrahedron a normal behind its closeness to it; 0: no surface; or null"}},
        {{"occluded", "shares of the faces to the voxels at lower x, y and z that surfaces occlude", "1"}}};
  }
  static void contents(const light_propagation_volumes::OccludedFaces& port, PortContents& contents) {
    for (std::size_t i = 0; i < port.levels.size(); ++i) {
      const auto& level = port.levels[i];
      contents.texture("occluded", level.occluded);
      contents.texture("moved", level.moved);
      contents.buffer("packed", level.packed);
      if (!level.occluded) continue;
      GridPlacement faces = level.grid;
      faces.resolution += 1;
      contents.field("occluded", VoxelBox::of(faces), VoxelTexels{{level.occluded}, {{0, 0}, {0, 1}, {0, 2}}},
                     static_cast<int>(i));
    }
  }
};

}  // namespace lumivox
