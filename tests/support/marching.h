// Media, g-buffers and ray marches for the tests of smoke.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/scene/medium.h"
#include "support/passes.h"

namespace lumivox::test {

inline constexpr int kPixels = 64;  ///< along both sides of the images here

inline gpu::TextureRef image(const std::vector<glm::vec4>& values) {
  std::vector<float> floats;
  for (const glm::vec4& value : values) floats.insert(floats.end(), {value.x, value.y, value.z, value.w});
  return textureOf(pixels(kPixels, kPixels), floats);
}

/// A g-buffer in which pixel i sees a surface at place(i), in metres.
inline GBuffer surfacesAt(const std::function<glm::vec3(int)>& place) {
  std::vector<glm::vec4> positions;
  for (int i = 0; i < kPixels * kPixels; ++i) positions.emplace_back(place(i), 1.0f);
  GBuffer result;
  result.position = image(positions);
  return result;
}

inline Scene emptyScene() {
  SceneBuilder builder;
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7, kPixels, kPixels);
  return builder.scene;
}

inline ScatteringGrid evenMedium(const glm::vec3& extinction, const glm::vec3& albedo, float anisotropy,
                                 const glm::vec3& low, const glm::vec3& high) {
  ScatteringGrid::Medium medium;
  medium.name = "even";
  medium.bounds.grow(low);
  medium.bounds.grow(high);
  medium.extinction = extinction;
  medium.albedo = albedo;
  medium.anisotropy = anisotropy;
  return {{medium}};
}

/// A medium with densities sampled at the centres of voxels.
inline ScatteringGrid varyingMedium(float extinction, float albedo, float anisotropy, const glm::vec3& low,
                                    float voxelSize, const glm::ivec3& size,
                                    const std::function<float(const glm::vec3&)>& densityAt) {
  ScatteringGrid result = evenMedium(glm::vec3(extinction), glm::vec3(albedo), anisotropy,
                                     low - 0.5f * voxelSize, low + voxelSize * (glm::vec3(size) + 0.5f));
  ScatteringGrid::Medium& medium = result.media.front();
  medium.grid = {low, voxelSize, size};
  std::vector<float> values;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        values.push_back(densityAt(low + voxelSize * (glm::vec3(x, y, z) + 0.5f)));
  medium.density = textureOf(volumeOf(size, gpu::Format::r32f), values);
  return result;
}

/// Smoke of three thousand particles.
inline Medium smokeFrom(const glm::dvec3& source) {
  Medium medium;
  medium.name = "smoke";
  medium.extinction = glm::vec3(2.0f);
  medium.albedo = glm::vec3(0.8f);
  medium.particles = 3000;
  medium.source = source;
  medium.spread = 0.2;
  medium.radius = 0.15;
  medium.rise = 0.4;
  medium.drift = 0.08;
  medium.life = 3.0;
  return medium;
}

struct Marched {
  ImageBuffer scattered, transmittance;
};
/// Images of `march` or `march_as_published` at full resolution.
inline Marched marchBy(const std::string& pass, const Scene& scene, const ScatteringGrid& media,
                       const GBuffer& gbuffer, const Settings& settings) {
  LonePass march("volumetric_smoke." + pass, scene, {{"resolution", "full"}});
  march.with(settings).in("gbuffer", gbuffer).in("media", media);
  if (!scene.lights.empty()) march.in("shadow", shadowsOf(scene));
  return {march.image("scattered"), march.image("transmittance")};
}
/// `march` with samples in the middle of its steps.
inline Marched march(const Scene& scene, const ScatteringGrid& media, const GBuffer& gbuffer, int steps,
                     const Settings& more = {}) {
  Settings settings{{"start", "middle"}, {"steps", steps}};
  settings.insert(settings.end(), more.begin(), more.end());
  return marchBy("march", scene, media, gbuffer, settings);
}

inline float valueOf(const ImageBuffer& image, int pixel, int channel = 0) {
  return image.at(pixel % kPixels, pixel / kPixels, channel);
}

inline double henyeyGreenstein(double g, double cosine) {
  return (1.0 - g * g) / (4.0 * kPi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

}  // namespace lumivox::test
