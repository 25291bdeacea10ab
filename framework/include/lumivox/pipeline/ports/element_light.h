#pragma once

#include "lumivox/pipeline/port.h"
#include "lumivox/pipeline/ports/surface_elements.h"

namespace lumivox {

/// Light at surface elements (SurfaceElements), on both sides. Texel k of a texture is at (k % kWidth, k /
/// kWidth). Irradiance: that of leaf i, at its front, is texel 2 i, that at its back texel 2 i + 1. Radiance:
/// that of disc i likewise; that of group i, towards +x, -x, +y, -y, +z, -z, begins at texel 2 firstGroup + 6
/// (i - firstGroup); `w` of a group's texel is the area of its discs that turn their fronts that way, as seen
/// from there, m^2: where it is 0, backs are seen.
struct ElementLight {
  static constexpr int kWidth = SurfaceElements::kWidth;
  gpu::TextureRef irradiance;
  /// Of what shines, by links; null where shadow maps bring it.
  gpu::TextureRef directIrradiance;
  gpu::TextureRef radiance;  ///< reflected, of as many bounces as reach the surface that is seen
  gpu::TextureRef emission;  ///< emitted; null like directIrradiance
  /// Radiance of glossy elements by direction. Null: none.
  gpu::BufferRef outgoing;
  int directions = 0;  ///< along a side of a face of the cube of directions of `outgoing`; 0: none

  /// Texels of a texture of radiance.
  static int radianceTexels(const SurfaceElements& elements) {
    return 2 * elements.firstGroup + 6 * (elements.nodeCount - elements.firstGroup);
  }
};

template <>
struct PortTraits<ElementLight> {
  static PortKind kind() {
    return {
        "ElementLight",
        "light that arrives at surface elements and leaves them, on both sides",
        {{"irradiance", "d2 rgba32f, two texels a leaf",
          "xyz irradiance of the front, then of the back, by what surfaces reflect and the environment, W/m^2"},
         {"directIrradiance", "d2 rgba32f, two texels a leaf", "the same by what shines"},
         {"radiance", "d2 rgba32f, two texels a disc, six a group",
          "xyz reflected radiance to the front and the back, or along the axes, W/(sr m^2)"},
         {"emission", "d2 rgba32f, two texels a disc, six a group", "the same that is emitted"},
         {"outgoing", "buffer", "radiance of glossy elements by direction, W/(sr m^2)"}}};
  }
  static void contents(const ElementLight& port, PortContents& contents) {
    contents.texture("irradiance", port.irradiance);
    contents.texture("directIrradiance", port.directIrradiance);
    contents.texture("radiance", port.radiance);
    contents.texture("emission", port.emission);
    contents.buffer("outgoing", port.outgoing);
  }
};

}  // namespace lumivox
