// Mean reflectances and emission of a piece of surface, and the share of it that masks leave.
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

/// The mean of kMaterialSamples samples on a square of the leaf's area around its place on its triangle.
LeafMaterial materialOfPiece(const Scene& scene, const Part& part, const Leaf& leaf);

/// A triangle at a vertex, with the part of its area that belongs to the vertex.
struct CornerPiece {
  std::uint32_t triangle;
  const Part* part;
  double area;
};
/// Means by area over the corners of triangles around a vertex.
LeafMaterial materialOfVertex(const Scene& scene, std::span<const CornerPiece> pieces, std::uint32_t vertex);

inline constexpr int kMaterialSamples = 16;

}  // namespace lumivox::implicit_visibility
