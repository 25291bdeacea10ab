#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// Small lights on surfaces: discs that reflect to one side, diffusely or
/// also by a Phong lobe. A disc without flux is no light.
struct SurfaceLights {
  gpu::BufferRef lights;
  int count = 0;
  int overlapping = 1;  ///< most that may lie upon each other: lit by so many, a patch is there so many times
};

template <>
struct PortTraits<SurfaceLights> {
  static PortKind kind() {
    return {
        "SurfaceLights",
        "small lights on surfaces",
        {{"lights", "buffer",
          "array of SurfaceLight in shaders/common/rsm.glsl: position, m, and area, m^2; normal; flux, W; and the lobe of a glossy patch (shaders/common/surface_lobe.glsl)"}}};
  }
  static void contents(const SurfaceLights& port, PortContents& contents) {
    contents.buffer("lights", port.lights);
  }
};

}  // namespace lumivox
