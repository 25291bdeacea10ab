#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// One opacity per voxel.
struct OccupancyGrid {
  GridPlacement grid;
  gpu::TextureRef opacity;
};

template <>
struct PortTraits<OccupancyGrid> {
  static PortKind kind() {
    return {"OccupancyGrid",
            "one opacity per voxel",
            {{"opacity", "d3 r8", "0..1"}},
            {{"opacity", "opacity", "1", PortField::Role::fog}},
            "voxels with an opacity above 0"};
  }
  static void contents(const OccupancyGrid& port, PortContents& contents) {
    contents.texture("opacity", port.opacity);
    const VoxelTexels opacity{{port.opacity}, {{0, 0}}};
    contents.field("opacity", VoxelBox::of(port.grid), opacity);
    contents.occupies(port.grid, opacity);
  }
};

}  // namespace lumivox
