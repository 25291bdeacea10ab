// Many places on the surface of a model, from which its points are chosen.
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
  int sides = 1;      ///< 2: of an open surface, or of one whose triangles do not all face the same way
  double area = 0.0;  ///< of one side, m^2
};

/// The facets of each model, those with an area. A triangle that is there twice, the same way round, is there
/// once.
std::vector<std::vector<Facet>> facetsOf(const Scene& scene, const std::vector<std::uint32_t>& models);

/// Places on facets; each stands for as much area.
struct SurfaceCandidates {
  std::vector<SurfacePlace> places;
  std::vector<std::uint32_t> facets;          ///< of each place
  std::vector<glm::vec3> positions, normals;  ///< at rest, m from `base`; of the front side, geometric
  double area = 0.0;                          ///< of one side, that each stands for, m^2
};

/// `count` places over the facets by their area, without those in holes of masks. `base` is near the model,
/// so that single precision tells its places apart.
SurfaceCandidates candidatesOn(const Scene& scene, const std::vector<Facet>& facets, std::size_t count,
                               const glm::dvec3& base);

}  // namespace lumivox::virtual_area_lights
