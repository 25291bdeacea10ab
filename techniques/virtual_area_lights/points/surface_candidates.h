// Candidate places on a model's surface, from which its points are chosen.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/scene/scene.h"
#include "surface_points.h"

namespace lumivox::virtual_area_lights {

/// A triangle at rest in the world.
struct Facet {
  std::uint32_t object = 0, triangle = 0;  ///< as SurfacePlace::triangle
  int material = 0;
  int sides = 1;      ///< 2 for an open surface, or one whose triangles do not all face the same way
  double area = 0.0;  ///< of one side, m^2
};

/// The facets of each model that have an area. Duplicates with the same winding count once.
std::vector<std::vector<Facet>> facetsOf(const Scene& scene, const std::vector<std::uint32_t>& models);

/// Places on facets, each standing for the same area.
struct SurfaceCandidates {
  std::vector<SurfacePlace> places;
  std::vector<std::uint32_t> facets;          ///< of each place
  std::vector<glm::vec3> positions, normals;  ///< at rest, m from `base`; of the front side, geometric
  double area = 0.0;                          ///< area of one side that each place stands for, m^2
};

/// Spreads `count` places over the facets by area and drops those in holes of masks. `base` is near the
/// model, so that single precision resolves its places.
SurfaceCandidates candidatesOn(const Scene& scene, const std::vector<Facet>& facets, std::size_t count,
                               const glm::dvec3& base);

}  // namespace lumivox::virtual_area_lights
