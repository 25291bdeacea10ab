#include "surface_candidates.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lumivox/base/low_discrepancy.h"
#include "lumivox/base/random.h"
#include "lumivox/scene/bilinear.h"
#include "lumivox/scene/topology.h"

namespace lumivox::virtual_area_lights {
namespace {

/// Whether each edge of a component is passed as often in one direction as in the other, so that all its
/// triangles face the same way.
bool facesOneWay(const WeldedObject& object, const SurfaceComponent& component) {
  struct Side {
    std::uint32_t low, high;
    int turn;
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  for (const std::uint32_t t : component.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = object.corners[3 * std::size_t{t} + k],
                          b = object.corners[3 * std::size_t{t} + (k + 1) % 3];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  std::sort(sides.begin(), sides.end());
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t end = first;
    int turns = 0;
    for (; end < sides.size() && sides[end].low == sides[first].low && sides[end].high == sides[first].high;
         ++end)
      turns += sides[end].turn;
    if (turns != 0) return false;
    first = end;
  }
  return true;
}

/// For each triangle of an object, the number of its sides that count.
std::vector<int> sidesOf(const WeldedObject& object) {
  std::vector<int> sides(object.triangleCount(), 0);
  for (const SurfaceComponent& component : surfaceComponents(object)) {
    const int count = component.closed() && facesOneWay(object, component) ? 1 : 2;
    for (const std::uint32_t t : component.triangles) sides[t] = count;
  }
  return sides;
}

std::array<glm::dvec3, 3> placedCorners(const Scene& scene, std::uint32_t object, std::uint32_t triangle) {
  std::array<glm::dvec3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k)
    corners[k] = glm::dvec3(
        scene.objects[object].placement *
        glm::dvec4(glm::dvec3(scene.positions[scene.indices[3 * std::size_t{triangle} + k]]), 1.0));
  return corners;
}

bool inHole(const Scene& scene, const Material& material, const SurfacePlace& place) {
  if (material.maskTexture < 0) return false;
  const auto texcoord = [&](std::size_t k) {
    return scene.texcoords[scene.indices[3 * std::size_t{place.triangle} + k]];
  };
  return cutOut(scene.textures[static_cast<std::size_t>(material.maskTexture)],
                (1.0f - place.second - place.third) * texcoord(0) + place.second * texcoord(1) +
                    place.third * texcoord(2));
}

}  // namespace

std::vector<std::vector<Facet>> facetsOf(const Scene& scene, const std::vector<std::uint32_t>& models) {
  std::vector<std::vector<Facet>> facets;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    if (facets.size() <= models[o]) facets.resize(models[o] + 1);
    const std::vector<int> sides = sidesOf(weld(scene, object));
    std::size_t number = 0;
    for (const Part& part : object.parts)
      for (std::uint32_t i = 0; i < part.indexCount; i += 3, ++number) {
        const std::uint32_t triangle = (part.firstIndex + i) / 3;
        const auto [a, b, c] = placedCorners(scene, o, triangle);
        const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
        if (sides[number] > 0 && area > 0.0)
          facets[models[o]].push_back({o, triangle, part.material, sides[number], area});
      }
  }
  return facets;
}

SurfaceCandidates candidatesOn(const Scene& scene, const std::vector<Facet>& facets, std::size_t count,
                               const glm::dvec3& base) {
  double whole = 0.0;
  for (const Facet& facet : facets) whole += facet.area;
  SurfaceCandidates made;
  made.area = whole / static_cast<double>(count);
  double before = 0.0;  // of the facets so far
  std::size_t next = 0;
  for (std::uint32_t f = 0; f < facets.size() && next < count; ++f) {
    const Facet& facet = facets[f];
    before += facet.area;
    const bool isLast = f + 1 == facets.size();
    const auto [a, b, c] = placedCorners(scene, facet.object, facet.triangle);
    const glm::vec3 normal(glm::normalize(glm::cross(b - a, c - a)));
    RandomStream random(0, facet.triangle);
    const double shiftX = static_cast<double>(random.uniform()),
                 shiftY = static_cast<double>(random.uniform());
    for (int i = 0; next < count && (isLast || (static_cast<double>(next) + 0.5) * made.area < before);
         ++i, ++next) {
      // Uniform over the triangle: rows of the square become lines to a corner.
      const auto [x, y] = r2Point(i);
      const double root = std::sqrt(1.0 - std::fmod(x + shiftX, 1.0)),
                   third = root * std::fmod(y + shiftY, 1.0);
      const SurfacePlace place{facet.triangle, static_cast<float>(root - third), static_cast<float>(third)};
      if (inHole(scene, scene.materials[static_cast<std::size_t>(facet.material)], place)) continue;
      made.places.push_back(place);
      made.facets.push_back(f);
      made.positions.emplace_back(a - base + static_cast<double>(place.second) * (b - a) +
                                  static_cast<double>(place.third) * (c - a));
      made.normals.push_back(normal);
    }
  }
  return made;
}

}  // namespace lumivox::virtual_area_lights
