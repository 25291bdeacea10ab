#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// All direct light as point samples: lights without extent are one sample each, emissive triangles several.
/// Each sample has zero or more shadow views (directional and spot 1, point and area 6 cube faces) that are
/// layers of one depth array.
struct ShadowMap {
  gpu::BufferRef lights;
  gpu::BufferRef views;
  gpu::TextureRef depth;
  int lightCount = 0;
  int layerCount = 0;
};

template <>
struct PortTraits<ShadowMap> {
  static PortKind kind() {
    return {"ShadowMap",
            "all direct light as point samples, with their visibility",
            {{"lights", "buffer", "array of LightSample in shaders/common/lights.glsl"},
             {"views", "buffer", "mat4 per layer: world to light clip space"},
             {"depth", "d2Array depth32f", "depth seen from each light, one layer for each view"}}};
  }
  static void contents(const ShadowMap& port, PortContents& contents) {
    contents.buffer("lights", port.lights);
    contents.buffer("views", port.views);
    contents.texture("depth", port.depth);
  }
};

}  // namespace lumivox
