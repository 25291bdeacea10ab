#pragma once

#include "../elements/surface_elements.h"
#include "lumivox/pipeline/port.h"

namespace lumivox::implicit_visibility {

/// Light at surface elements (SurfaceElements), on both sides. Texel k of a texture is at (k % kWidth, k /
/// kWidth). Irradiance: that of leaf i, at its front, is texel 2 i, that at its back texel 2 i + 1. Radiance:
/// that of disc i likewise; that of group i, towards +x, -x, +y, -y, +z, -z, begins at texel 2 firstGroup + 6
/// (i - firstGroup); `w` of a group's texel is the area of its discs that turn their fronts that way, as seen
/// from there, m^2: where it is 0, backs are seen.
struct ElementLight {
  static constexpr int kWidth = SurfaceElements::kWidth;
  gpu::TextureRef irradiance;
  /// Irradiance from emitters, by links; null where shadow maps supply it.
  gpu::TextureRef directIrradiance;
  gpu::TextureRef radiance;  ///< reflected, of as many bounces as reach the surface that is seen
  gpu::TextureRef emission;  ///< emitted; null like directIrradiance
  /// What nodes with a glossy leaf reflect by their Phong lobes, beside `radiance`: one row per node, one
  /// texel per direction of an even cube of bins (direction_bins.h). Null where no node passes such light on.
  gpu::TextureRef outgoing;
  gpu::BufferRef outgoingRows;  ///< row of each node, kNoElement: none; null like `outgoing`
  int directions = 0;           ///< along a side of a face of the cube of directions of `outgoing`; 0: none

  /// Texels of a texture of radiance.
  static int radianceTexels(const SurfaceElements& elements) {
    return 2 * elements.firstGroup + 6 * (elements.nodeCount - elements.firstGroup);
  }
};

}  // namespace lumivox::implicit_visibility

namespace lumivox {

template <>
struct PortTraits<implicit_visibility::ElementLight> {
  static PortKind kind() {
    return {
        "ElementLight",
        "light that arrives at surface elements and light that leaves them, on both sides",
        {{"irradiance", "d2 rgba32f, two texels a leaf",
          "xyz irradiance of the front, then of the back, from reflected light and the environment, W/m^2"},
         {"directIrradiance", "d2 rgba32f, two texels a leaf", "the same from emitted light"},
         {"radiance", "d2 rgba32f, two texels a disc, six a group",
          "xyz reflected radiance to the front and the back, or along the axes, W/(sr m^2)"},
         {"emission", "d2 rgba32f, two texels a disc, six a group", "emitted radiance, in the same order"},
         {"outgoing", "d2 rgba32f, a texel for each direction of each node with a glossy leaf",
          "xyz radiance that its Phong lobe reflects in a direction, W/(sr m^2)"},
         {"outgoingRows", "buffer", "word a node: its row in `outgoing`; 2^32 - 1: none"}}};
  }
  static void contents(const implicit_visibility::ElementLight& port, PortContents& contents) {
    contents.texture("irradiance", port.irradiance);
    contents.texture("directIrradiance", port.directIrradiance);
    contents.texture("radiance", port.radiance);
    contents.texture("emission", port.emission);
    contents.texture("outgoing", port.outgoing);
    contents.buffer("outgoingRows", port.outgoingRows);
  }
};

}  // namespace lumivox
