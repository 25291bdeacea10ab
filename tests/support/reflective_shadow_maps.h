// The passes of reflective shadow maps alone, from maps and scenes that a test makes, and what comes of them.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "scene_builder.h"
#include "techniques.h"

namespace lumivox::test {

struct Map {
  double flux = 0.0, area = 0.0;  ///< sums over all texels
  ReflectiveShadowMap value;
};

inline Map render(const Scene& scene, int size) {
  PassHarness harness(device(), techniques(), "reflective_shadow_maps", "render", scene,
                      snapshotOf(scene, 0.0));
  harness.setParameter("size", size);
  harness.setParameter("area_size", size);
  harness.run();
  Map map;
  map.value = harness.output<ReflectiveShadowMap>("map");
  const std::vector<float> flux = map.value.flux->downloadFloats(0),
                           normal = map.value.normal->downloadFloats(0),
                           position = map.value.position->downloadFloats(0);
  for (std::size_t i = 0; i < flux.size(); i += 4) {
    map.flux += flux[i];
    if (position[i + 3] > 0.0f) map.area += normal[i + 3];
  }
  return map;
}

inline SceneBuilder closedBox(float albedo) {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(albedo), true);
  return builder;
}

inline GBuffer surfacePoints(const glm::vec3& position, const glm::vec3& normal) {
  gpu::TextureDescription description;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = 8;
  const auto filled = [&](const glm::vec4& value) {
    auto texture = std::make_shared<gpu::Texture>(device(), description, "test g-buffer");
    texture->clear(value);
    return texture;
  };
  return {filled(glm::vec4(position, 1)),
          filled(glm::vec4(normal, 1)),
          filled(glm::vec4(normal, 0)),
          filled(glm::vec4(1.0f)),
          nullptr,
          nullptr};
}

/// A map of one texel a layer, each with a place, a normal with an area, and a flux.
struct Texel {
  glm::vec4 position, normal, flux;
};
inline ReflectiveShadowMap mapOf(const std::vector<Texel>& texels) {
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d2Array;
  description.format = gpu::Format::rgba32f;
  description.depth = static_cast<int>(texels.size());
  const auto filled = [&](glm::vec4 Texel::*member) {
    auto texture = std::make_shared<gpu::Texture>(device(), description, "test map");
    std::vector<float> floats;
    for (const Texel& texel : texels)
      for (int c = 0; c < 4; ++c) floats.push_back((texel.*member)[c]);
    texture->uploadFloats(0, floats);
    return texture;
  };
  ReflectiveShadowMap map;
  map.position = filled(&Texel::position);
  map.normal = filled(&Texel::normal);
  map.flux = filled(&Texel::flux);
  map.lights = std::make_shared<gpu::Buffer>(device(), 64, "lights");
  map.views = std::make_shared<gpu::Buffer>(device(), 64 * texels.size(), "views");
  map.lightCount = 1;
  map.layerCount = static_cast<int>(texels.size());
  return map;
}

using Settings = std::vector<std::pair<std::string, std::variant<double, std::string>>>;

struct TakenLight {
  glm::vec4 positionArea, normal, flux;
  bool operator==(const TakenLight&) const = default;
};

/// SurfaceLight of shaders/common/rsm.glsl.
inline std::vector<TakenLight> lightsIn(const SurfaceLights& lights) {
  std::vector<TakenLight> values = lights.lights->downloadValues<TakenLight>();
  values.resize(static_cast<std::size_t>(lights.count));
  return values;
}

inline SurfaceLights choose(const ReflectiveShadowMap& map, const Settings& settings) {
  const Scene scene = SceneBuilder().scene;
  PassHarness harness(device(), techniques(), "reflective_shadow_maps", "choose", scene,
                      snapshotOf(scene, 0.0));
  harness.setInput("map", map);
  for (const auto& [name, value] : settings)
    std::visit([&, &key = name](const auto& set) { harness.setParameter(key, set); }, value);
  harness.run();
  return harness.output<SurfaceLights>("lights");
}

/// By `method` of gather, or, with `flux`, from as many chosen lights.
inline void gatherBy(PassHarness& harness, const ReflectiveShadowMap& map, const std::string& method,
                     int samples) {
  if (method == "flux") {
    harness.setInput("lights", choose(map, {{"lights", static_cast<double>(samples)}}));
  } else {
    harness.setInput("map", map);
    harness.setParameter("method", method);
    harness.setParameter("samples", samples);
  }
  harness.run();
}

/// The light reflected by a white surface at the origin that faces up, by so many samples.
inline glm::vec3 reflectedAtOrigin(const ReflectiveShadowMap& map, const char* method, int samples) {
  SceneBuilder builder;
  builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  PassHarness harness(device(), techniques(), "reflective_shadow_maps", "gather", builder.scene,
                      snapshotOf(builder.scene, 0.0));
  harness.setInput("gbuffer", surfacePoints({0, 0, 0}, {0, 1, 0}));
  gatherBy(harness, map, method, samples);
  const ImageBuffer image = imageOf(*harness.output<Image>("diffuse").texture);
  return {image.at(3, 3, 0), image.at(3, 3, 1), image.at(3, 3, 2)};
}

inline ImageBuffer gather(const Scene& scene, const ReflectiveShadowMap& map, const char* method,
                          int samples) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness view(device(), techniques(), "direct_lighting", "gbuffer", scene, snapshot);
  view.run();
  PassHarness harness(device(), techniques(), "reflective_shadow_maps", "gather", scene, snapshot);
  harness.setInput("gbuffer", view.output<GBuffer>("gbuffer"));
  gatherBy(harness, map, method, samples);
  return imageOf(*harness.output<Image>("diffuse").texture);
}

}  // namespace lumivox::test
