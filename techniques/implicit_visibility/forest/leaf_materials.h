// What a piece of the surface reflects and emits on average, and how much of it masks leave.
#pragma once

#include <span>

#include "origins.h"

namespace lumivox::implicit_visibility {

struct LeafMaterial {
  float covered = 1.0f;  ///< share of the samples that lie in no hole
  glm::vec3 albedo{0.0f};
  glm::vec4 specular{0.0f};
  glm::vec3 emission{0.0f};
  Leaf on(Leaf leaf) const;
};

/// Around a leaf's place on its triangle, on a square of its area: the mean of kMaterialSamples samples.
LeafMaterial materialOfPiece(const Scene& scene, const Part& part, const Leaf& leaf);

/// A triangle at a vertex, and the part of its area that is the vertex's.
struct CornerPiece {
  std::uint32_t triangle;
  const Part* part;
  double area;
};
/// Means by area over the corners of triangles around a vertex.
LeafMaterial materialOfVertex(const Scene& scene, std::span<const CornerPiece> pieces, std::uint32_t vertex);

inline constexpr int kMaterialSamples = 16;

}  // namespace lumivox::implicit_visibility
