// Media, g-buffers and marches through them, for the tests of smoke.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

namespace lumivox::test {

inline constexpr int kPixels = 64;  ///< along both sides of the images here

inline gpu::TextureRef image(const std::vector<glm::vec4>& values) {
  gpu::TextureDescription description;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = kPixels;
  auto texture = std::make_shared<gpu::Texture>(device(), description, "test image");
  std::vector<float> floats;
  for (const glm::vec4& value : values) floats.insert(floats.end(), {value.x, value.y, value.z, value.w});
  texture->uploadFloats(0, floats);
  return texture;
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

/// Densities at the centres of voxels.
inline ScatteringGrid varyingMedium(float extinction, float albedo, float anisotropy, const glm::vec3& low,
                                    float voxelSize, const glm::ivec3& size,
                                    const std::function<float(const glm::vec3&)>& densityAt) {
  ScatteringGrid result = evenMedium(glm::vec3(extinction), glm::vec3(albedo), anisotropy,
                                     low - 0.5f * voxelSize, low + voxelSize * (glm::vec3(size) + 0.5f));
  ScatteringGrid::Medium& medium = result.media.front();
  medium.grid = {low, voxelSize, size};
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d3;
  description.format = gpu::Format::r32f;
  description.width = size.x;
  description.height = size.y;
  description.depth = size.z;
  medium.density = std::make_shared<gpu::Texture>(device(), description, "test density");
  std::vector<float> values;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        values.push_back(densityAt(low + voxelSize * (glm::vec3(x, y, z) + 0.5f)));
  medium.density->uploadFloats(0, values);
  return result;
}

struct Marched {
  ImageBuffer scattered, transmittance;
};
using Settings = std::vector<std::pair<std::string, std::string>>;

/// Full resolution, steps looked at in their middle.
inline Marched march(const Scene& scene, const ScatteringGrid& media, const GBuffer& gbuffer, int steps,
                     const Settings& words = {},
                     const std::vector<std::pair<std::string, int>>& numbers = {}) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness shadow(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
  PassHarness harness(device(), techniques(), "volumetric_smoke", "march", scene, snapshot);
  harness.setParameter("resolution", std::string("full"));
  harness.setParameter("start", std::string("middle"));
  harness.setParameter("steps", steps);
  for (const auto& [name, word] : words) harness.setParameter(name, word);
  for (const auto& [name, number] : numbers) harness.setParameter(name, number);
  harness.setInput("gbuffer", gbuffer);
  harness.setInput("media", media);
  if (!scene.lights.empty()) {
    shadow.run();
    harness.setInput("shadow", shadow.output<ShadowMap>("depth"));
  }
  harness.run();
  return {imageOf(*harness.output<Image>("scattered").texture),
          imageOf(*harness.output<Image>("transmittance").texture)};
}

inline float valueOf(const ImageBuffer& image, int pixel, int channel = 0) {
  return image.at(pixel % kPixels, pixel / kPixels, channel);
}

inline double henyeyGreenstein(double g, double cosine) {
  return (1.0 - g * g) / (4.0 * kPi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

}  // namespace lumivox::test
