// The pass that gathers along rays through bits, on what tests make by hand.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "lumivox/toolkit/light_samples.h"
#include "support/bit_grids.h"
#include "support/scene_builder.h"

namespace lumivox::test::near_field {

inline gpu::TextureRef filledLayers(int side, int layers, const glm::vec4& value) {
  auto texture = std::make_shared<gpu::Texture>(
      device(),
      gpu::TextureDescription{gpu::TextureKind::d2Array, gpu::Format::rgba32f, side, side, layers, 1},
      "test layers");
  texture->clear(value);
  return texture;
}

/// The same surface point in all pixels.
inline GBuffer pointsAt(const glm::vec3& position, const glm::vec3& normal, int width = 8, int height = 8) {
  const gpu::TextureDescription image{.format = gpu::Format::rgba32f, .width = width, .height = height};
  const auto filled = [&](const glm::vec4& value) {
    auto texture = std::make_shared<gpu::Texture>(device(), image, "test g-buffer");
    texture->clear(value);
    return texture;
  };
  return {filled(glm::vec4(position, 1)),
          filled(glm::vec4(normal, 1)),
          filled(glm::vec4(normal, 0)),
          filled(glm::vec4(0.5f)),
          nullptr,
          nullptr};
}

struct Setting {
  const char* name;
  double number = 0;
  const char* word = nullptr;
};

/// A pass that sends rays through a grid of metre-wide voxels: `gather`, or another technique's.
class Gatherer {
 public:
  explicit Gatherer(const BinaryGrid& bits, const Scene& scene = SceneBuilder().scene, int width = 8,
                    int height = 8, const char* technique = "near_field_voxels", const char* pass = "gather")
      : scene_(withImage(scene, width, height)),
        harness_(std::make_unique<PassHarness>(device(), techniques(), technique, pass, *scene_,
                                               snapshotOf(*scene_, 0.0))) {
    harness_->setInput("bits", bits);
  }
  PassHarness& harness() { return *harness_; }
  Gatherer& at(const glm::vec3& position, const glm::vec3& normal, int width = 8, int height = 8) {
    harness_->setInput("gbuffer", pointsAt(position, normal, width, height));
    return *this;
  }
  Gatherer& map(const ReflectiveShadowMap& map) {
    harness_->setInput("map", map);
    return *this;
  }
  Gatherer& with(std::initializer_list<Setting> settings) {
    for (const Setting& one : settings)
      one.word != nullptr ? harness_->setParameter(one.name, std::string(one.word))
                          : harness_->setParameter(one.name, one.number);
    return *this;
  }
  std::vector<float> run(const char* output = "arriving") {
    harness_->run();
    return harness_->output<Image>(output).texture->downloadFloats(0);
  }
  /// The first channel's mean over the pixels.
  double mean(const char* output = "arriving") {
    const std::vector<float> values = run(output);
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); i += 4) sum += values[i];
    return 4.0 * sum / static_cast<double>(values.size());
  }

 private:
  static std::unique_ptr<Scene> withImage(Scene scene, int width, int height) {
    scene.cameras.front().width = width;
    scene.cameras.front().height = height;
    return std::make_unique<Scene>(std::move(scene));
  }
  std::unique_ptr<Scene> scene_;  // which the harness refers to
  std::unique_ptr<PassHarness> harness_;
};

inline constexpr glm::vec3 kUp(0.0f, 1.0f, 0.0f);

inline Scene underSky(float radiance) {
  SceneBuilder builder;
  builder.scene.environment = glm::vec3(radiance);
  return builder.scene;
}

/// Form factor from a point with a normal to a polygon in front of it (Lambert).
inline double formFactor(const glm::dvec3& point, const glm::dvec3& normal,
                         const std::vector<glm::dvec3>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::normalize(corners[i] - point),
                     b = glm::normalize(corners[(i + 1) % corners.size()] - point);
    const glm::dvec3 across = glm::cross(a, b);
    sum += std::atan2(glm::length(across), glm::dot(a, b)) * glm::dot(glm::normalize(across), normal);
  }
  return std::abs(sum) / (2.0 * kPi);
}

/// Lights of a scene as samples, and a map of their layers in which all texels are alike.
inline ReflectiveShadowMap mapOf(const Scene& scene, int side, const glm::vec4& position,
                                 const glm::vec4& normal, const glm::vec4& flux) {
  const LightSet set = sampleLights(scene, snapshotOf(scene, 0.0), 1, side);
  ReflectiveShadowMap map;
  map.lightCount = static_cast<int>(set.samples.size());
  map.layerCount = static_cast<int>(set.views.size());
  REQUIRE(map.layerCount > 0);
  std::vector<glm::mat4> views;
  for (const LightView& view : set.views) views.push_back(view.worldToClip);
  map.lights =
      std::make_shared<gpu::Buffer>(device(), set.samples.size() * sizeof(LightSampleData), "lights");
  map.lights->uploadValues(std::span<const LightSampleData>(set.samples));
  map.views = std::make_shared<gpu::Buffer>(device(), views.size() * sizeof(glm::mat4), "views");
  map.views->uploadValues(std::span<const glm::mat4>(views));
  map.position = filledLayers(side, map.layerCount, position);
  map.normal = filledLayers(side, map.layerCount, normal);
  map.flux = filledLayers(side, map.layerCount, flux);
  return map;
}

/// What a Lambert surface of this radiance sends from a square metre.
inline glm::vec4 fluxOf(float radiance) {
  return {glm::vec3(static_cast<float>(kPi) * radiance), 0.0f};
}

/// A light of a kind that shines from above into a room of 32 m around the origin, where metres are voxels.
inline Scene lightOf(const std::string& kind) {
  SceneBuilder builder;
  builder.box(glm::vec3(-16.0f), glm::vec3(16.0f), builder.lambert(0.5f), true);
  const glm::dvec3 place(7, 14, 6.5), downwards(0.1, -1, 0.2);
  if (kind == "directional") builder.light(LightKind::directional, glm::vec3(1.0f), {}, downwards);
  if (kind == "point") builder.light(LightKind::point, glm::vec3(1.0f), place);
  if (kind == "spot") {
    Light& light = builder.light(LightKind::spot, glm::vec3(1.0f), place, downwards);
    light.innerAngle = light.outerAngle = 0.8;
  }
  if (kind == "area") builder.quad({6, 14, 6}, {1, 0, 0}, {0, 0, 1}, builder.lambert(0.0f, 1.0f));
  return builder.scene;
}

/// A single set voxel, and rays that all go straight up into its middle.
struct OneVoxel {
  VoxelSet set{{16, 16, 16}};
  glm::vec3 centre{8.5f, 6.5f, 8.5f};
  OneVoxel() { set.insert({8, 6, 8}); }
  Gatherer gatherer(const ReflectiveShadowMap& map) const {
    Gatherer result(gridOf(set));
    result.at({8.5f, 2.0f, 8.5f}, kUp)
        .map(map)
        .with({{"rays", 1}, {"spread", 0}, {"hit", 0, "centre"}, {"front", 0, "off"}});
    return result;
  }
};

}  // namespace lumivox::test::near_field
