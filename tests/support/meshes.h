// Meshes whose triangles share vertices, and spheres.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "support/scene_builder.h"

namespace lumivox::test {

struct Mesh {
  std::vector<glm::vec3> places;
  std::vector<std::uint32_t> corners;
};

/// Adds an object with this mesh and the material of this index.
inline Object& addMesh(Scene& scene, const Mesh& mesh, int material = 0) {
  if (scene.materials.empty()) scene.materials.emplace_back();
  Object object;
  object.name = "mesh " + std::to_string(scene.objects.size());
  object.firstVertex = static_cast<std::uint32_t>(scene.positions.size());
  object.vertexCount = static_cast<std::uint32_t>(mesh.places.size());
  object.parts.push_back({material, static_cast<std::uint32_t>(scene.indices.size()),
                          static_cast<std::uint32_t>(mesh.corners.size())});
  scene.positions.insert(scene.positions.end(), mesh.places.begin(), mesh.places.end());
  scene.normals.resize(scene.positions.size(), glm::vec3(0, 1, 0));
  scene.texcoords.resize(scene.positions.size(), glm::vec2(0.0f));
  for (const std::uint32_t corner : mesh.corners) scene.indices.push_back(object.firstVertex + corner);
  scene.objects.push_back(object);
  return scene.objects.back();
}

/// A sphere of rings with one vertex at each pole and no duplicate vertices.
inline Mesh sphereMesh(const glm::vec3& centre, float radius, int rings, bool inwards = false) {
  Mesh mesh;
  const int around = 2 * rings;
  mesh.places.push_back(centre + glm::vec3(0, radius, 0));
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double theta = kPi * i / rings, phi = 2.0 * kPi * j / around;
      mesh.places.push_back(centre + radius * glm::vec3(std::sin(theta) * std::sin(phi), std::cos(theta),
                                                        std::sin(theta) * std::cos(phi)));
    }
  mesh.places.push_back(centre - glm::vec3(0, radius, 0));
  const auto at = [&](int i, int j) {
    if (i == 0) return std::uint32_t{0};
    if (i == rings) return static_cast<std::uint32_t>(mesh.places.size() - 1);
    return static_cast<std::uint32_t>(1 + (i - 1) * around + j % around);
  };
  const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (inwards) std::swap(b, c);
    mesh.corners.insert(mesh.corners.end(), {a, b, c});
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      if (i > 0) triangle(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i < rings - 1) triangle(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return mesh;
}

/// A box that faces outwards.
inline Mesh boxMesh(const glm::vec3& low, const glm::vec3& high) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.places.emplace_back((k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y,
                             (k & 4) != 0 ? high.z : low.z);
  mesh.corners = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  return mesh;
}

/// A sphere of radius 1 around the origin, with vertices of its own for each triangle.
inline std::vector<glm::vec3> sphereCorners(int rings) {
  const Mesh mesh = sphereMesh(glm::vec3(0.0f), 1.0f, rings);
  std::vector<glm::vec3> corners;
  for (const std::uint32_t corner : mesh.corners) corners.push_back(mesh.places[corner]);
  return corners;
}

}  // namespace lumivox::test
