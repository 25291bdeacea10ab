// Lights and the discs that cones to them are aimed at: a kind of port of this technique's own. GLSL side:
// shaders/voxel_cone_tracing/cones/soft_shadows.comp.
#pragma once

#include <glm/glm.hpp>

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// All direct light as point samples. Each belongs to a disc: that of its light, or its own.
struct LightDiscs {
  gpu::BufferRef lights;
  gpu::BufferRef discs;
  gpu::BufferRef discOfSample;
  int lightCount = 0;  ///< samples
};

template <>
struct PortTraits<LightDiscs> {
  static PortKind kind() {
    return {"LightDiscs",
            "all direct light as point samples, and the discs that cones to them are aimed at",
            {{"lights", "buffer", "array of LightSample in shaders/common/lights.glsl"},
             {"discs", "buffer",
              "vec4 of the centre, m, and the radius, m; vec4 of the mean normal, 0 without one"},
             {"discOfSample", "buffer", "a word for each sample: its disc"}}};
  }
  static void contents(const LightDiscs& port, PortContents& contents) {
    contents.buffer("lights", port.lights);
    contents.buffer("discs", port.discs);
    contents.buffer("discOfSample", port.discOfSample);
  }
};

}  // namespace lumivox
