// The pass that gathers along rays through bits, on inputs that tests make.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/toolkit/light_samples.h"
#include "support/bit_grids.h"
#include "support/passes.h"

namespace lumivox::test::near_field {

/// A pass that sends rays through a grid of metre-wide voxels: `gather`, or another technique's.
class Gatherer : public LonePass {
 public:
  explicit Gatherer(const BinaryGrid& bits, const Scene& scene = SceneBuilder().scene, int width = 8,
                    int height = 8, const char* pass = "near_field_voxels.gather")
      : LonePass(pass, withImage(scene, width, height)) {
    in("bits", bits);
  }
  Gatherer& at(const glm::vec3& position, const glm::vec3& normal, const glm::ivec2& size = {8, 8}) {
    in("gbuffer", gbufferAt({position, normal, glm::vec3(0.5f)}, size));
    return *this;
  }
  Gatherer& map(const ReflectiveShadowMap& map) {
    in("map", map);
    return *this;
  }
  Gatherer& with(const Settings& settings) {
    LonePass::with(settings);
    return *this;
  }
  /// The pixels of output `arriving`, rgba.
  std::vector<float> arriving() { return floats("arriving"); }
  /// The first channel's mean over the pixels.
  double mean(const char* output) {
    const std::vector<float> values = floats(output);
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); i += 4) sum += values[i];
    return 4.0 * sum / static_cast<double>(values.size());
  }

 private:
  static Scene withImage(Scene scene, int width, int height) {
    scene.cameras.front().width = width;
    scene.cameras.front().height = height;
    return scene;
  }
};

inline constexpr glm::vec3 kUp(0.0f, 1.0f, 0.0f);

inline Scene underSky(float radiance) {
  SceneBuilder builder;
  builder.scene.environment = glm::vec3(radiance);
  return builder.scene;
}

/// A reflective shadow map of a scene's lights in which all texels have the given values.
inline ReflectiveShadowMap mapOf(const Scene& scene, int side, const glm::vec4& position,
                                 const glm::vec4& normal, const glm::vec4& flux) {
  const LightSet set = sampleLights(scene, snapshotOf(scene, 0.0), 1, side);
  ReflectiveShadowMap map;
  map.lightCount = static_cast<int>(set.samples.size());
  map.layerCount = static_cast<int>(set.views.size());
  REQUIRE(map.layerCount > 0);
  std::vector<glm::mat4> views;
  for (const LightView& view : set.views) views.push_back(view.worldToClip);
  map.lights = bufferOf(set.samples);
  map.views = bufferOf(views);
  map.position = filled(layers(side, side, map.layerCount), position);
  map.normal = filled(layers(side, side, map.layerCount), normal);
  map.flux = filled(layers(side, side, map.layerCount), flux);
  return map;
}

/// The flux per square metre of a Lambert surface of this radiance.
inline glm::vec4 fluxOf(float radiance) {
  return {glm::vec3(static_cast<float>(kPi) * radiance), 0.0f};
}

/// A room of 32 m around the origin under a light of this kind from above. Metres are voxels.
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

/// A single occupied voxel, and rays that all go straight up into its centre.
struct OneVoxel {
  VoxelSet set{{16, 16, 16}};
  glm::vec3 centre{8.5f, 6.5f, 8.5f};
  OneVoxel() { set.insert({8, 6, 8}); }
  Gatherer gatherer(const ReflectiveShadowMap& map) const {
    Gatherer result(gridOf(set));
    result.at({8.5f, 2.0f, 8.5f}, kUp)
        .map(map)
        .with({{"rays", 1}, {"spread", 0}, {"hit", "centre"}, {"front", "off"}});
    return result;
  }
  /// Whether the map lights a receiver above that faces down, by our walk or as printed. No component of its
  /// ray is 0, since the printed walk divides by them.
  glm::dvec3 down = glm::normalize(glm::dvec3(0.01, -1, 0.013)),
             above = glm::dvec3(centre) - (12.0 - 6.5) / -down.y * down;
  bool isLitFromAbove(bool asPrinted, const ReflectiveShadowMap& map, const Settings& settings = {}) const {
    Gatherer result = gatherer(map);
    result.at(above, down)
        .with({{"tolerance", 1},
               {"front", "on"},
               {"hit", asPrinted ? "printed" : "centre"},
               {"as_published", asPrinted ? "on" : "off"}})
        .with(settings);
    return result.arriving()[0] > 0.0f;
  }
};

}  // namespace lumivox::test::near_field
