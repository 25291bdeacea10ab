// Scenes made by code, piece by piece: for tests and for the cases of the stress battery.
#pragma once

#include <cassert>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// Every piece is an object of its own. What the loader would check is not checked.
class SceneBuilder {
 public:
  SceneBuilder() {
    scene.name = "made by code";
    scene.cameras.push_back(Camera{});
  }

  int material(const Material& material) {
    scene.materials.push_back(material);
    return static_cast<int>(scene.materials.size()) - 1;
  }
  int lambert(float albedo, float emission = 0.0f) {
    Material made;
    made.diffuse = glm::vec3(albedo);
    made.emission = glm::vec3(emission);
    return material(made);
  }
  int phong(float diffuse, float specular, float exponent) {
    Material made;
    made.diffuse = glm::vec3(diffuse);
    made.specular = glm::vec3(specular);
    made.exponent = exponent;
    return material(made);
  }

  /// A parallelogram whose front side is that of cross(edge1, edge2); texture coordinates run along the
  /// edges.
  Object& quad(const glm::vec3& corner, const glm::vec3& edge1, const glm::vec3& edge2, int materialIndex) {
    const glm::vec3 normal = glm::normalize(glm::cross(edge1, edge2));
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    for (const glm::vec2 uv : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
      scene.positions.push_back(corner + uv.x * edge1 + uv.y * edge2);
      scene.normals.push_back(normal);
      scene.texcoords.push_back(uv);
    }
    Object object;
    object.name = "quad " + std::to_string(scene.objects.size());
    object.firstVertex = first;
    object.vertexCount = 4;
    object.parts.push_back({materialIndex, static_cast<std::uint32_t>(scene.indices.size()), 6});
    for (const std::uint32_t index : {0u, 1u, 2u, 0u, 2u, 3u}) scene.indices.push_back(first + index);
    scene.objects.push_back(object);
    return scene.objects.back();
  }

  /// Any triangles, three corners each, with flat normals; texture coordinates are (0, 0). A triangle without
  /// area gets a normal along y.
  Object& mesh(const std::vector<glm::vec3>& corners, int materialIndex) {
    assert(corners.size() % 3 == 0);
    Object object;
    object.name = "mesh " + std::to_string(scene.objects.size());
    object.firstVertex = static_cast<std::uint32_t>(scene.positions.size());
    object.vertexCount = static_cast<std::uint32_t>(corners.size());
    object.parts.push_back({materialIndex, static_cast<std::uint32_t>(scene.indices.size()),
                            static_cast<std::uint32_t>(corners.size())});
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      const glm::dvec3 cross =
          glm::cross(glm::dvec3(corners[i + 1] - corners[i]), glm::dvec3(corners[i + 2] - corners[i]));
      const double size = glm::length(cross);
      const glm::vec3 normal = size > 0.0 ? glm::vec3(cross / size) : glm::vec3(0, 1, 0);
      for (std::size_t k = 0; k < 3; ++k) {
        scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
        scene.positions.push_back(corners[i + k]);
        scene.normals.push_back(normal);
        scene.texcoords.emplace_back(0.0f);
      }
    }
    scene.objects.push_back(object);
    return scene.objects.back();
  }

  /// The six inner sides of an axis-aligned box, or its six outer sides.
  void box(const glm::vec3& low, const glm::vec3& high, int materialIndex, bool inwards) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool upper : {false, true}) {
        glm::vec3 corner = low, edge1(0.0f), edge2(0.0f);
        if (upper) corner[axis] = high[axis];
        const int next = (axis + 1) % 3, last = (axis + 2) % 3;
        edge1[next] = high[next] - low[next];
        edge2[last] = high[last] - low[last];
        // cross(edge1, edge2) points along +axis: into the box from its lower side.
        if (upper == inwards) std::swap(edge1, edge2);
        quad(corner, edge1, edge2, materialIndex);
      }
    }
  }

  Camera& look(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up, double fov, int width,
               int height) {
    Camera& camera = scene.cameras.front();
    camera.name = "main";
    camera.eye = eye, camera.target = target, camera.up = up;
    camera.fov = fov, camera.width = width, camera.height = height;
    return camera;
  }

  Light& light(LightKind kind, const glm::vec3& power, const glm::dvec3& position,
               const glm::dvec3& direction = {0, -1, 0}) {
    Light made;
    made.name = "light " + std::to_string(scene.lights.size());
    made.kind = kind;
    made.power = power;
    made.position = position;
    made.direction = glm::normalize(direction);
    scene.lights.push_back(made);
    return scene.lights.back();
  }

  Scene scene;
};

}  // namespace lumivox
