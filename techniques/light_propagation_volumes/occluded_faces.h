// The surfaces in the cells of light propagation: a kind of port of this technique's own.
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
        "the occluded shares of the faces between the cells of an ShGrid",
        {{"occluded", "d3 rgba8, for each level, one voxel larger",
          "xyz occluded shares of the faces to the voxels at lower x, y and z; or null"},
         {"moved", "d3 rgba8, for each level, one voxel larger",
          "bytes for the same faces: how far surfaces were moved onto them, in fourteenths of a voxel; low four bits: surfaces that face down the axis and lie above; high four bits: the others; or null"},
         {"packed", "buffer, for each level",
          "five words for each voxel, x first (thesis Gomes 2015, Listings 4.26 to 4.29): albedo over pi below its contrast, and for each face of a tetrahedron a normal below its closeness to the face; 0: no surface; or null"}},
        {{"occluded", "occluded shares of the faces to the voxels at lower x, y and z", "1"}}};
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
