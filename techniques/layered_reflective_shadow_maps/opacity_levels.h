// Opacities of voxels with coarser levels: a kind of port of this technique's own.
#pragma once

#include "lumivox/pipeline/port.h"
#include "lumivox/pipeline/ports.h"

namespace lumivox {

/// One opacity per voxel, one mip per halving.
struct OpacityLevels {
  GridPlacement grid;  ///< of the finest level
  gpu::TextureRef opacity = nullptr;
  int filledLevels = 0;  ///< mip levels that hold values, finest first; 0: all that the texture has
  /// As RadianceGrid::Opacity.
  RadianceGrid::Opacity opacityOf = RadianceGrid::Opacity::ofVoxel;
};

template <>
struct PortTraits<OpacityLevels> {
  static PortKind kind() {
    return {
        "OpacityLevels",
        "one opacity per voxel, one mip per halving",
        {{"opacity", "d3 r8 with mips", "0..1"}},
        {{"opacity", "opacity", "1", PortField::Role::fog}},
        "voxels with an opacity above 0",
        {{"filledLevels", "mip levels that hold values, finest first; 0: all that the texture has",
          "undefined memory is read as opacity", "of coarser levels"},
         {"opacityOf",
          "whether the opacity of a coarser voxel is that across the whole voxel, or along a path of one finest voxel in it",
          "coarser voxels are too opaque or too transparent", "of coarser levels"}}};
  }
  static int levelsOf(const OpacityLevels& port) {
    return port.filledLevels == 0 ? port.opacity->description().levels : port.filledLevels;
  }
  static void contents(const OpacityLevels& port, PortContents& contents) {
    contents.texture("opacity", port.opacity, {.levels = levelsOf(port)});
    for (int level = 0; level < levelsOf(port); ++level)
      contents.field("opacity", VoxelBox::of(port.grid, levelResolution(port.grid.resolution, level)),
                     VoxelTexels{{port.opacity}, {{0, 0}}, level}, level);
    contents.occupies(port.grid, VoxelTexels{{port.opacity}, {{0, 0}}});
  }
};

}  // namespace lumivox
