// Connectivity of an object's triangles, and the volume that they enclose, if any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// An object's triangles with vertices at the same place taken as one. Places are compared exactly, in object
/// space at rest: a modeller's split vertices (for normals, texture coordinates, materials) are copies.
struct WeldedObject {
  /// Numbers of places, three per triangle, from 0; triangles in the order of the parts.
  std::vector<std::uint32_t> corners;
  /// Where each triangle's indices begin in Scene::indices.
  std::vector<std::uint32_t> firstIndices;
  std::vector<glm::vec3> places;

  std::size_t triangleCount() const { return firstIndices.size(); }
};
WeldedObject weld(const Scene& scene, const Object& object);

/// Triangles that share edges with each other.
struct SurfaceComponent {
  std::vector<std::uint32_t> triangles;  ///< of WeldedObject
  std::size_t openEdges = 0;             ///< with an odd number of triangles: the surface has a border there
  double volume = 0.0;  ///< signed, in the object's units: positive where the front sides look out
  /// Every edge has an even number of triangles, so that every straight line crosses the surface an even
  /// number of times. Which way they face does not matter.
  bool closed() const { return openEdges == 0; }
};

/// In the order of their first triangles. A triangle that is there twice, the same way round, counts once; a
/// side without length is no edge.
std::vector<SurfaceComponent> surfaceComponents(const WeldedObject& object);

}  // namespace lumivox
