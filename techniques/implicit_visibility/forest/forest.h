// Trees above leaves, and the state of their nodes at a time (Dong et al. 2007, Sec. 4.1 and 4.2.1).
#pragma once

#include <memory>

#include "../elements/element_tree.h"
#include "origins.h"

namespace lumivox::implicit_visibility {

/// Whether an element keeps the area that it has at rest, as published, or follows stretching.
enum class Areas { now, rest };

/// The part of elements that stays the same while the scene moves: leaves in the order of the tree, the tree,
/// and for each node means weighted by area at rest.
struct Forest {
  Origins origins;
  std::shared_ptr<const ElementTree> tree;
  std::vector<glm::vec4> albedo, specular, emission;  ///< as the textures of SurfaceElements
  bool glossy = false, emissive = false;              ///< whether any leaf is
  std::vector<float>
      restTriangleArea;  ///< for each leaf the area of its triangle, or of all triangles at its vertex, m^2
};

/// Segments are quadtrees over leaves in Morton order of their plane. Above them stand groups of four nearby
/// roots: first within an object, then among still objects and among moving objects separately, so that still
/// objects are linked in the same way at all times.
Forest plantForest(const Scene& scene, Origins origins);

/// Leaves follow their triangles or vertices; nodes are means by area. A leaf without area or normal has area
/// 0.
ElementState stateOf(const Forest& forest, const Scene& scene, const SceneSnapshot& snapshot, Areas areas);

}  // namespace lumivox::implicit_visibility
