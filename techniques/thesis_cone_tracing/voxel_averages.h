// Running averages of the light in voxels (thesis Gomes 2015, Listing 4.9): a kind of port of this
// technique's own.
#pragma once

#include <vector>

#include "lumivox/pipeline/ports.h"

namespace lumivox::thesis_cone_tracing {

/// Radiance reflected by the fragments of each voxel, averaged in 8 bits in order of arrival (thesis Gomes
/// 2015, Listing 4.9), in units of `unit`, with the number of fragments modulo 256 in place of the opacity.
struct VoxelAverages {
  GridPlacement grid;
  /// One for all sides, or six for the faces of DirectionalRadianceGrid.
  std::vector<gpu::TextureRef> grids;
  float unit = 1.0f;  ///< W/(sr m^2) that the byte 255 stands for
};

}  // namespace lumivox::thesis_cone_tracing

namespace lumivox {

template <>
struct PortTraits<thesis_cone_tracing::VoxelAverages> {
  static PortKind kind() {
    return {"VoxelAverages",
            "running averages of the light that fragments reflect, in 8 bits",
            {{"averages", "d3 r32ui, one or six",
              "bytes, lowest first: rgb radiance / unit, and the fragments of the voxel modulo 256"}}};
  }
  static void contents(const thesis_cone_tracing::VoxelAverages& port, PortContents& contents) {
    for (const gpu::TextureRef& grid : port.grids) contents.texture("averages", grid);
  }
};

}  // namespace lumivox
