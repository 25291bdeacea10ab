// Which sparse points each vertex refers to (Lensing and Broll 2013, Sec. 3.2 step 3).
#pragma once

#include <cstdint>
#include <vector>

#include "../points/surface_points.h"

namespace lumivox::virtual_area_lights {

/// The nearest points of every vertex of a scene, found once, at rest: what is rigid keeps them, and what
/// deforms refers to those that were near.
struct VertexNeighbours {
  static constexpr std::uint32_t kNone = 0xffffffff;
  int sides = 1;  ///< of a vertex; 1: no surface has points on its back
  /// `neighbours` for each side of each vertex, the nearest first, kNone behind the last: of the vertex's
  /// model and on that side.
  std::vector<std::uint32_t> any;
  std::vector<std::uint32_t> glossy;  ///< the same of points that reflect by the vertex's exponent
};
VertexNeighbours neighboursOfVertices(const Scene& scene, const SurfacePointSet& set, int neighbours);

}  // namespace lumivox::virtual_area_lights
