#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// The surfaces that the camera sees, per pixel. Positions are metres relative to the snapshot's origin.
struct GBuffer {
  gpu::TextureRef position;
  gpu::TextureRef normal;
  gpu::TextureRef geometricNormal;
  gpu::TextureRef diffuse;
  gpu::TextureRef specular;
  gpu::TextureRef emission;
};

template <>
struct PortTraits<GBuffer> {
  static PortKind kind() {
    constexpr auto kAny = PortResource::Sign::any;
    return {
        "GBuffer",
        "what the camera sees, per pixel",
        {{"position", "d2 rgba32f", "posWorld, m; w = 1 on a surface, else 0", kAny},
         {"normal", "d2 rgba32f",
          "unit shading normal facing the camera; w = 1 for the front side, 0 for the back", kAny},
         {"geometricNormal", "d2 rgba32f",
          "unit normal of the triangle facing the camera; w = number of the model: objects that move together; 0 for static ones",
          kAny},
         {"diffuse", "d2 rgba32f", "diffuse albedo"},
         {"specular", "d2 rgba32f", "Phong albedo, exponent in w; null where nothing is glossy"},
         {"emission", "d2 rgba32f", "emitted radiance towards the camera; null where nothing emits"}}};
  }
  static void contents(const GBuffer& port, PortContents& contents) {
    contents.texture("position", port.position);
    contents.texture("normal", port.normal);
    contents.texture("geometricNormal", port.geometricNormal);
    contents.texture("diffuse", port.diffuse);
    contents.texture("specular", port.specular);
    contents.texture("emission", port.emission);
  }
};

}  // namespace lumivox
