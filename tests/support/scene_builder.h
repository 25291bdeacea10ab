// Scenes made by code, small enough that their light is known in closed form.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <string>
#include <utility>

#include "lumivox/reference/path_tracer.h"
#include "lumivox/scene/scene.h"

namespace lumivox::test {

inline constexpr double kPi = std::numbers::pi;

/// Options without a progress bar and without the cache.
inline ReferenceOptions quietly(int samples, int bounces = 32) {
  ReferenceOptions options;
  options.samplesPerPixel = samples;
  options.bounces = bounces;
  options.progress = false;
  options.useCache = false;
  return options;
}

struct Estimate {
  double mean = 0.0,
         deviation = 0.0;  ///< of the mean over all pixels and channels, from the stated variances
};

/// Mean of a layer. Its channels share paths, so their errors are taken as one; those of pixels are
/// independent.
inline Estimate estimateOf(const LayeredPicture& picture, const std::string& layer) {
  const Picture& means = picture.layers.at(layer);
  const Picture& variances = picture.layers.at(layer + ".variance");
  const auto pixels = static_cast<double>(means.pixelCount()),
             channels = static_cast<double>(means.channels());
  Estimate result;
  double variance = 0.0;
  for (const float value : means.values()) result.mean += value / (pixels * channels);
  for (const float value : variances.values()) variance += value / channels;
  result.deviation = std::sqrt(variance) / pixels;
  return result;
}

/// Builds a Scene piece by piece; every piece is an object of its own.
class SceneBuilder {
 public:
  SceneBuilder() {
    scene.name = "made by a test";
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

/// A room with an emissive lamp under its ceiling, coloured side walls, a diffuse and a glossy box; the front
/// is open.
inline Scene litRoom(int width, int height) {
  SceneBuilder builder;
  Material red, green;
  red.diffuse = {0.63f, 0.06f, 0.05f};
  green.diffuse = {0.15f, 0.48f, 0.09f};
  const int white = builder.lambert(0.73f), redWall = builder.material(red),
            greenWall = builder.material(green);
  const int lamp = builder.lambert(0.78f, 15.0f), shiny = builder.phong(0.3f, 0.6f, 30.0f);
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, white);
  builder.quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, white);
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, white);
  builder.quad({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, redWall);
  builder.quad({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, greenWall);
  builder.quad({0.35f, 0.99f, 0.35f}, {0.3f, 0, 0}, {0, 0, 0.3f}, lamp);
  builder.box({0.15f, 0.001f, 0.2f}, {0.45f, 0.6f, 0.5f}, white, false);
  builder.box({0.55f, 0.001f, 0.55f}, {0.85f, 0.3f, 0.85f}, shiny, false);
  builder.look({0.5, 0.5, 2.4}, {0.5, 0.5, 0}, {0, 1, 0}, 0.7, width, height);
  return builder.scene;
}

}  // namespace lumivox::test
