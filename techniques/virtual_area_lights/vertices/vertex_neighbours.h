// Which sparse points each vertex refers to (Lensing and Broll 2013, Sec. 3.2 step 3).
#pragma once

#include <cstdint>
#include <vector>

#include "../points/surface_points.h"

namespace lumivox::virtual_area_lights {

/// The nearest points of every vertex of a scene, found once, at rest. Rigid objects keep them; deforming
/// objects refer to those that were near at rest.
struct VertexNeighbours {
  static constexpr std::uint32_t kNone = 0xffffffff;
  int sides = 1;  ///< of a vertex; 1: no surface has points on its back
  /// For each side of each vertex `neighbours` points of its model on that side, the nearest first, kNone
  /// behind the last.
  std::vector<std::uint32_t> any;
  std::vector<std::uint32_t> glossy;  ///< the same for points that reflect by the vertex's exponent
};
VertexNeighbours neighboursOfVertices(const Scene& scene, const SurfacePointSet& set, int neighbours);

}  // namespace lumivox::virtual_area_lights
