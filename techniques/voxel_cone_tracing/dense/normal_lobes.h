// The sides to which surfaces in voxels shine: a kind of port of this technique's own.
#pragma once

#include "lumivox/pipeline/port.h"
#include "lumivox/pipeline/ports.h"

namespace lumivox::voxel_cone_tracing {

/// Normal lobes of lit surfaces, one mip per halving (Crassin et al. 2011, Sec. 5; thesis Gomes 2015, Sec.
/// 3.1.2): the mean D of normals, turned to the lit side and weighted by the light that they reflect. Its
/// length |D| is 1 where all normals agree, and the variance of the lobe is (1 - |D|) / |D| (Toksvig 2005).
/// Vectors and weights are both sums, so that filtering is linear.
struct NormalLobes {
  GridPlacement grid;
  gpu::TextureRef lobes;  ///< xyz: sum of normals times light; w: sum of light, W/(sr m^2)
};

}  // namespace lumivox::voxel_cone_tracing

namespace lumivox {

template <>
struct PortTraits<voxel_cone_tracing::NormalLobes> {
  static PortKind kind() {
    return {"NormalLobes",
            "to which side the surfaces in voxels shine, one mip per halving",
            {{"lobes", "d3 rgba32f with mips", "xyz normals of lit sides times light, w light",
              PortResource::Sign::any}},
            {{"normal", "mean normal of lit sides, multiplied by the light that they reflect", "W/(sr m^2)"},
             {"light", "the light that they reflect, mean of the channels", "W/(sr m^2)"}}};
  }
  static void contents(const voxel_cone_tracing::NormalLobes& port, PortContents& contents) {
    contents.texture("lobes", port.lobes);
    for (int level = 0; level < port.lobes->description().levels; ++level) {
      const VoxelBox box = VoxelBox::of(port.grid, levelResolution(port.grid.resolution, level));
      contents.field("normal", box, VoxelTexels{{port.lobes}, {{0, 0}, {0, 1}, {0, 2}}, level}, level);
      contents.field("light", box, VoxelTexels{{port.lobes}, {{0, 3}}, level}, level);
    }
  }
};

}  // namespace lumivox
