// Which sparse points each vertex of the meshes refers to: a kind of port of this technique's own.
#pragma once

#include <cstdint>
#include <memory>

#include "../points/surface_points.h"
#include "lumivox/pipeline/port.h"

namespace lumivox::virtual_area_lights {

/// The nearest points of every vertex of Scene::positions, found once, at rest (vertex_neighbours.h).
struct VertexPoints {
  gpu::BufferRef any, glossy;
  gpu::BufferRef objects;                      ///< uint a vertex: the object that it belongs to
  int sides = 1;                               ///< of a vertex; 1: no surface has points on its back
  int neighbours = 0;                          ///< that each side of a vertex refers to, at most
  std::shared_ptr<const SurfacePointSet> set;  ///< the points that are referred to
};

}  // namespace lumivox::virtual_area_lights

namespace lumivox {

template <>
struct PortTraits<virtual_area_lights::VertexPoints> {
  static PortKind kind() {
    return {
        "VertexPoints",
        "the sparse points that each vertex of the meshes refers to",
        {{"any", "buffer",
          "`neighbours` uint for each side of each vertex: numbers of points of its model on that side, the "
          "nearest first; all bits: none"},
         {"glossy", "buffer", "the same of points that reflect by the vertex's exponent"},
         {"objects", "buffer", "uint for each vertex: its object"}}};
  }
  static void contents(const virtual_area_lights::VertexPoints& port, PortContents& contents) {
    contents.buffer("any", port.any);
    contents.buffer("glossy", port.glossy);
    contents.buffer("objects", port.objects);
  }
};

}  // namespace lumivox
