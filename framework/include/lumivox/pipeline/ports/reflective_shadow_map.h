#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// The surfaces that each light sees, as a source of one-bounce light (Dachsbacher & Stamminger 2005): every
/// texel is a small light. Lights and layers are those of a ShadowMap with the same settings; all layers have
/// one size. A map that a depth camera captured (captured_frames.lights) has layers of any shape, eyes
/// without power in the place of lights, and no views.
struct ReflectiveShadowMap {
  gpu::BufferRef lights;
  gpu::BufferRef views;
  gpu::TextureRef position;
  gpu::TextureRef normal;
  gpu::TextureRef flux;  ///< that of diffuse surfaces, and of their Phong lobes where the maker adds these
  /// What the surfaces reflect, for paths that go on from them: null unless a reader asks for it.
  gpu::TextureRef albedo = nullptr;
  gpu::TextureRef specular = nullptr;  ///< null also where nothing is glossy
  int lightCount = 0;
  int layerCount = 0;
  bool captured = false;  ///< by a depth camera: of what stands around virtual content; no views
  int overlapping = 0;    ///< most lights that see one patch of surface; 0: all may
};

template <>
struct PortTraits<ReflectiveShadowMap> {
  static PortKind kind() {
    constexpr auto kAny = PortResource::Sign::any;
    return {"ReflectiveShadowMap",
            "the surfaces that each light sees: every texel is a small light",
            {{"lights", "buffer", "array of LightSample in shaders/common/lights.glsl"},
             {"views", "buffer", "mat4 per layer: world to light clip space"},
             {"position", "d2Array rgba32f", "posWorld; w = 1 on a surface, else 0", kAny},
             {"normal", "d2Array rgba32f",
              "unit normal towards the light; w = the surface area that the texel covers, m^2", kAny},
             {"flux", "d2Array rgba32f", "reflected flux of the texel, W; w = number of the layer's light"},
             {"albedo", "d2Array rgba32f", "diffuse albedo; null unless asked for"},
             {"specular", "d2Array rgba32f",
              "Phong albedo, exponent in w; null unless asked for, and where nothing is glossy"}}};
  }
  static void contents(const ReflectiveShadowMap& port, PortContents& contents) {
    contents.buffer("lights", port.lights);
    contents.buffer("views", port.views);
    contents.texture("position", port.position);
    contents.texture("normal", port.normal);
    contents.texture("flux", port.flux);
    contents.texture("albedo", port.albedo);
    contents.texture("specular", port.specular);
  }
};

}  // namespace lumivox
