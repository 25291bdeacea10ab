// Single passes of reflective shadow maps on maps and scenes that a test makes, and their results.
#pragma once

#include <string>
#include <vector>

#include "support/passes.h"

namespace lumivox::test {

struct Map {
  double flux = 0.0, area = 0.0;  ///< sums over all texels
  ReflectiveShadowMap value;
};

inline Map render(const Scene& scene, int size) {
  Map map;
  map.value = LonePass("reflective_shadow_maps.render", scene, {{"size", size}, {"area_size", size}})
                  .out<ReflectiveShadowMap>("map");
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

/// A map with one texel per layer, each with a position, a normal with an area, and a flux.
struct Texel {
  glm::vec4 position, normal, flux;
};
inline ReflectiveShadowMap mapOf(const std::vector<Texel>& texels) {
  const auto texture = [&](glm::vec4 Texel::*member) {
    std::vector<float> floats;
    for (const Texel& texel : texels)
      for (int c = 0; c < 4; ++c) floats.push_back((texel.*member)[c]);
    return textureOf(layers(1, 1, static_cast<int>(texels.size())), floats);
  };
  ReflectiveShadowMap map;
  map.position = texture(&Texel::position);
  map.normal = texture(&Texel::normal);
  map.flux = texture(&Texel::flux);
  map.lights = bufferOf(std::vector<glm::mat4>(1));
  map.views = bufferOf(std::vector<glm::mat4>(texels.size()));
  map.lightCount = 1;
  map.layerCount = static_cast<int>(texels.size());
  return map;
}

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
  return LonePass("reflective_shadow_maps.choose", SceneBuilder().scene, settings)
      .in("map", map)
      .out<SurfaceLights>("lights");
}

/// Gathers by a `method` of the pass or, for "flux", from `samples` lights of pass `choose`. `pass` must have
/// its g-buffer.
inline ImageBuffer gatherBy(LonePass& pass, const ReflectiveShadowMap& map, const std::string& method,
                            int samples) {
  if (method == "flux")
    pass.in("lights", choose(map, {{"lights", samples}}));
  else
    pass.in("map", map).with({{"method", method}, {"samples", samples}});
  return pass.image("diffuse");
}

/// The irradiance at a place whose surface faces up.
inline glm::vec3 irradianceAt(const glm::vec3& place, const ReflectiveShadowMap& map,
                              const std::string& method, int samples, const Settings& settings = {},
                              const Scene* seen = nullptr) {
  SceneBuilder builder;
  builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  LonePass pass("reflective_shadow_maps.gather", seen != nullptr ? *seen : builder.scene, settings);
  pass.in("gbuffer", gbufferAt({place, {0, 1, 0}}));
  const ImageBuffer image = gatherBy(pass, map, method, samples);
  return static_cast<float>(kPi) * glm::vec3(image.at(3, 3, 0), image.at(3, 3, 1), image.at(3, 3, 2));
}

inline ImageBuffer gather(const Scene& scene, const ReflectiveShadowMap& map, const std::string& method,
                          int samples) {
  LonePass pass("reflective_shadow_maps.gather", scene);
  pass.in("gbuffer", gbufferOf(scene));
  return gatherBy(pass, map, method, samples);
}

}  // namespace lumivox::test
