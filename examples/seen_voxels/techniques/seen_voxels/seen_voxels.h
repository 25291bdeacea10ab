// A port kind that the technique adds to the framework's.
#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// Voxels in which the camera sees a surface.
struct SeenVoxels {
  GridPlacement grid;
  gpu::TextureRef seen;  ///< d3 r8: 1 in those voxels, else 0
};

template <>
struct PortTraits<SeenVoxels> {
  static PortKind kind() {
    return {"SeenVoxels",
            "voxels in which the camera sees a surface",
            {{"seen", "d3 r8", "1 where a surface is seen"}},
            {{"seen", "whether a surface is seen", "1", PortField::Role::fog}},
            "voxels in which a surface is seen"};
  }
  static void contents(const SeenVoxels& port, PortContents& contents) {
    contents.texture("seen", port.seen);
    const VoxelTexels seen{{port.seen}, {{0, 0}}};
    contents.field("seen", VoxelBox::of(port.grid), seen);
    contents.occupies(port.grid, seen);
  }
};

}  // namespace lumivox
