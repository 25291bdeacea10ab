#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// One bit per voxel in stacks along z (Thiedemann et al. 2011): bit b of component c of texel (i, j) of
/// layer l is voxel (i, j, 128 l + 32 c + b). Mip levels halve x and y alone; a texel is the union of those
/// below.
struct BinaryGrid {
  static constexpr int kStack = 128;  ///< voxels in one texel
  GridPlacement grid;
  gpu::TextureRef stacks;
};

template <>
struct PortTraits<BinaryGrid> {
  static PortKind kind() {
    return {"BinaryGrid",
            "one bit per voxel in stacks along z, with levels that halve x and y",
            {{"stacks", "d2Array rgba32ui",
              "bit b of component c of layer l: voxel 128 l + 32 c + b of its column"}},
            {{"occupancy", "whether a surface touches the voxel", "1"}},
            "voxels whose bit is set"};
  }
  static void contents(const BinaryGrid& port, PortContents& contents) {
    contents.texture("stacks", port.stacks);
    const int levels = port.stacks ? port.stacks->description().levels : 0;
    for (int level = 0; level < levels; ++level) {
      glm::ivec3 resolution = levelResolution(port.grid.resolution, level);
      resolution.z = port.grid.resolution.z;
      contents.field("occupancy", VoxelBox::of(port.grid, resolution), VoxelBits{port.stacks, level}, level);
    }
    contents.occupies(port.grid, VoxelBits{port.stacks, 0});
  }
};

}  // namespace lumivox
