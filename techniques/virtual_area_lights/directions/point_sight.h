// What surface points see of each other: a kind of port of this technique's own.
#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox::virtual_area_lights {

/// The nearest disc in each of kDirections directions of every point of SurfacePoints. GLSL side:
/// shaders/virtual_area_lights/directions/sight.glsl.
struct PointSight {
  static constexpr int kDirections = 64;  ///< kSightSide squared in sight.glsl
  gpu::BufferRef nearest;                 ///< null: nothing occludes
};

}  // namespace lumivox::virtual_area_lights

namespace lumivox {

template <>
struct PortTraits<virtual_area_lights::PointSight> {
  static PortKind kind() {
    return {
        "PointSight",
        "the nearest disc in each direction of the surface points",
        {{"nearest", "buffer",
          "64 uint for each point, a grid of 8 x 8 directions of equal form factor: in the upper half the "
          "distance of the nearest disc, the upper 16 bits of a float, m; in the lower half the number of the "
          "disc's point; all bits: none"}}};
  }
  static void contents(const virtual_area_lights::PointSight& port, PortContents& contents) {
    contents.buffer("nearest", port.nearest);
  }
};

}  // namespace lumivox
