#pragma once

#include "lumivox/pipeline/port.h"
#include "points/surface_points_port.h"

namespace lumivox::virtual_area_lights {

/// Many small lights averaged to one for each point of SurfacePoints and each lobe (Lensing and Broll 2013,
/// Sec. 3.2). Point i is texel (i % kWidth, i / kWidth).
struct SparseLight {
  static constexpr int kWidth = SurfacePoints::kWidth;
  gpu::TextureRef diffuse, diffusePosition;
  gpu::TextureRef glossy, glossyPosition;  ///< null where nothing is glossy
};

}  // namespace lumivox::virtual_area_lights

namespace lumivox {

template <>
struct PortTraits<virtual_area_lights::SparseLight> {
  static PortKind kind() {
    constexpr auto kAny = PortResource::Sign::any;
    return {
        "SparseLight",
        "the light of many small lights, averaged to one light for each surface point and lobe",
        {{"diffuse", "d2 rgba32f, a texel a point",
          "xyz radiance of the averaged light, W/(sr m^2): times the albedo it is the light that the point reflects; once normalised, also divided by the averaged light's cosine; w radiance of the brightest light on the point"},
         {"diffusePosition", "d2 rgba32f, a texel a point",
          "xyz position of the averaged light, posWorld, m; w radius of its sphere, m", kAny},
         {"glossy", "d2 rgba32f, a texel a point",
          "the same for the Phong lobe towards the camera; w 1 + exponent of the lobe, 0 without one"},
         {"glossyPosition", "d2 rgba32f, a texel a point", "the same for the Phong lobe", kAny}}};
  }
  static void contents(const virtual_area_lights::SparseLight& port, PortContents& contents) {
    contents.texture("diffuse", port.diffuse);
    contents.texture("diffusePosition", port.diffusePosition);
    contents.texture("glossy", port.glossy);
    contents.texture("glossyPosition", port.glossyPosition);
  }
};

}  // namespace lumivox
