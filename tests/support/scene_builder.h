// Scenes built in code, simple enough that their light has a closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "lumivox/reference/path_tracer.h"
#include "lumivox/scene/builder.h"

namespace lumivox::test {

inline constexpr double kPi = std::numbers::pi;

/// Options without progress bar and cache.
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
         deviation = 0.0;  ///< of the mean over all pixels and channels, by the stored variances
};

/// The mean of a layer. The channels share paths, so their errors count as fully correlated; those of pixels
/// are independent.
inline Estimate estimateOf(const LayeredImage& image, const std::string& layer) {
  const ImageBuffer& means = image.layers.at(layer);
  const ImageBuffer& variances = image.layers.at(layer + ".variance");
  const auto pixels = static_cast<double>(means.pixelCount()),
             channels = static_cast<double>(means.channels());
  Estimate result;
  double variance = 0.0;
  for (const float value : means.values()) result.mean += value / (pixels * channels);
  for (const float value : variances.values()) variance += value / channels;
  result.deviation = std::sqrt(variance) / pixels;
  return result;
}

/// A room with an area light under its ceiling, coloured side walls, a diffuse and a glossy box; the front
/// is open.
inline Scene litRoom(int width, int height) {
  SceneBuilder builder;
  Material red, green;
  red.diffuse = {0.63f, 0.06f, 0.05f};
  green.diffuse = {0.15f, 0.48f, 0.09f};
  const int white = builder.lambert(0.73f), redWall = builder.material(red),
            greenWall = builder.material(green);
  const int areaLight = builder.lambert(0.78f, 15.0f), shiny = builder.phong(0.3f, 0.6f, 30.0f);
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, white);
  builder.quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, white);
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, white);
  builder.quad({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, redWall);
  builder.quad({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, greenWall);
  builder.quad({0.35f, 0.99f, 0.35f}, {0.3f, 0, 0}, {0, 0, 0.3f}, areaLight);
  builder.box({0.15f, 0.001f, 0.2f}, {0.45f, 0.6f, 0.5f}, white, false);
  builder.box({0.55f, 0.001f, 0.55f}, {0.85f, 0.3f, 0.85f}, shiny, false);
  builder.look({0.5, 0.5, 2.4}, {0.5, 0.5, 0}, {0, 1, 0}, 0.7, width, height);
  return builder.scene;
}

/// The same scene with all surfaces flipped that do not emit.
inline Scene turnedOver(Scene scene) {
  const auto shines = [&](const Part& part) {
    return scene.materials[static_cast<std::size_t>(part.material)].emission != glm::vec3(0.0f);
  };
  for (const Object& object : scene.objects) {
    if (std::any_of(object.parts.begin(), object.parts.end(), shines)) continue;
    for (const Part& part : object.parts)
      for (std::uint32_t i = part.firstIndex; i < part.firstIndex + part.indexCount; i += 3)
        std::swap(scene.indices[i + 1], scene.indices[i + 2]);
    for (std::uint32_t i = object.firstVertex; i < object.firstVertex + object.vertexCount; ++i)
      scene.normals[i] = -scene.normals[i];
  }
  return scene;
}

/// A floor with a patch under a spot of 1 W/sr and, unless `bright` is 0, another patch under a spot of
/// `bright` W/sr.
inline SceneBuilder floorUnderTwoSpots(float bright) {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  const auto spot = [&](float intensity, double x) {
    Light& light = builder.light(LightKind::spot, glm::vec3(intensity), {x, 0.5, 0});
    light.innerAngle = 0.2;
    light.outerAngle = 0.5;
  };
  spot(1.0f, -0.6);
  if (bright > 0.0f) spot(bright, 0.6);
  return builder;
}

}  // namespace lumivox::test
