// Texels of reflective shadow maps as lights.
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/toolkit/loop_limit.h"
#include "support/facts.h"
#include "support/reflective_shadow_maps.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("lights chosen by flux are those in which the shares of a tree of sums end") {
  // As choose.comp, in the same single precision: sums of sixteen, of the first layer's first row on. Only
  // green, so that the luminance is one product.
  ReflectiveShadowMap map = render(litRoom(16, 16), 24).value;
  std::vector<float> fluxes = map.flux->downloadFloats(0);
  for (std::size_t i = 0; i < fluxes.size(); i += 4) fluxes[i] = fluxes[i + 2] = 0.0f;
  map.flux->uploadFloats(0, fluxes);
  constexpr std::size_t kLights = 300, kFan = 16;
  const std::vector<float> positions = map.position->downloadFloats(0),
                           normals = map.normal->downloadFloats(0);
  std::vector<std::vector<float>> levels(1);
  for (std::size_t i = 0; i < fluxes.size(); i += 4) levels[0].push_back(fluxes[i + 1] * 0.7152f);
  while (levels.back().size() > 1) {
    std::vector<float> sums((levels.back().size() + kFan - 1) / kFan, 0.0f);
    for (std::size_t i = 0; i < levels.back().size(); ++i) sums[i / kFan] += levels.back()[i];
    levels.push_back(sums);
  }
  const float total = levels.back().front();
  const std::vector<TakenLight> chosen = lightsIn(choose(map, {{"lights", 300.0}}));
  REQUIRE(chosen.size() == kLights);
  for (std::size_t j = 0; j < kLights; ++j) {
    float rest = total * ((static_cast<float>(j) + 0.5f) / static_cast<float>(kLights)), weight = 0.0f;
    std::size_t entry = 0;
    for (std::size_t level = levels.size() - 1; level-- > 0; rest += weight) {
      const std::size_t first = kFan * entry, end = std::min(first + kFan, levels[level].size());
      entry = first, weight = 0.0f;
      for (std::size_t child = first; child < end; ++child) {
        if (levels[level][child] <= 0.0f) continue;
        entry = child, weight = levels[level][child];
        rest -= weight;
        if (rest < 0.0f) break;
      }
    }
    const float copies = total / (static_cast<float>(kLights) * weight);
    const auto texel = [&](const std::vector<float>& values) {
      return glm::vec4(values[4 * entry], values[4 * entry + 1], values[4 * entry + 2],
                       values[4 * entry + 3]);
    };
    CAPTURE(j, entry);
    REQUIRE(glm::vec3(chosen[j].positionArea) == glm::vec3(texel(positions)));
    REQUIRE(chosen[j].normal == glm::vec4(glm::vec3(texel(normals)), 0.0f));
    REQUIRE(chosen[j].positionArea.w == Approx(texel(normals).w * copies).epsilon(1e-6));
    REQUIRE(chosen[j].flux.y == Approx(texel(fluxes).y * copies).epsilon(1e-6));
  }
}

TEST_CASE(
    "a stride of 1 takes every texel as it is, a longer one the middles of squares with all of their texels' number") {
  const ReflectiveShadowMap map = render(litRoom(16, 16), 10).value;
  const auto count = static_cast<std::size_t>(map.layerCount);
  const std::vector<float> positions = map.position->downloadFloats(0),
                           normals = map.normal->downloadFloats(0), fluxes = map.flux->downloadFloats(0);
  const auto at = [](const std::vector<float>& values, std::size_t texel, float times) {
    return times * glm::vec3(values[4 * texel], values[4 * texel + 1], values[4 * texel + 2]);
  };
  const std::vector<TakenLight> all = lightsIn(choose(map, {{"method", "stride"}}));
  REQUIRE(all.size() == 100 * count);
  for (std::size_t i = 0; i < all.size(); ++i)
    REQUIRE(all[i] == TakenLight{glm::vec4(at(positions, i, 1.0f), normals[4 * i + 3]),
                                 glm::vec4(at(normals, i, 1.0f), 0.0f),
                                 glm::vec4(at(fluxes, i, 1.0f), 0.0f)});
  // Squares of four texels, the last of a row and a column of two.
  const std::vector<TakenLight> some = lightsIn(choose(map, {{"method", "stride"}, {"stride", 4.0}}));
  REQUIRE(some.size() == 9 * count);
  const std::array<std::size_t, 3> middles{2, 6, 9}, sizes{4, 4, 2};
  for (std::size_t i = 0; i < some.size(); ++i) {
    const std::size_t x = i % 3, y = i / 3 % 3, texel = i / 9 * 100 + middles[y] * 10 + middles[x];
    const auto copies = static_cast<float>(sizes[x] * sizes[y]);
    REQUIRE(some[i] == TakenLight{glm::vec4(at(positions, texel, 1.0f), copies * normals[4 * texel + 3]),
                                  glm::vec4(at(normals, texel, 1.0f), 0.0f),
                                  glm::vec4(at(fluxes, texel, copies), 0.0f)});
  }
}

TEST_CASE("gathering every light of stride 1 is gathering all texels") {
  const Scene scene = litRoom(16, 16);
  // More lights than a loop may have.
  const ReflectiveShadowMap map = render(scene, 32).value;
  const SurfaceLights lights = choose(map, {{"method", "stride"}});
  REQUIRE(lights.count > kLoopLimit);
  const ImageBuffer sum = LonePass("reflective_shadow_maps.gather", scene)
                              .in("gbuffer", gbufferOf(scene))
                              .in("lights", lights)
                              .image("diffuse"),
                    all = gather(scene, map, "all", 1);
  CHECK(compare(sum, all).rmse.value < 1e-5 * compare(ImageBuffer(16, 16, 3), all).rmse.value);
}

TEST_CASE("a light that faces the lamp has an area smaller than its surface's by the cosine between them") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.6f));
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {1, -1, 0});
  builder.light(LightKind::point, glm::vec3(3.0f), {0.2, 0.7, 0.1});
  const ReflectiveShadowMap map = render(builder.scene, 32).value;
  const std::vector<TakenLight> surface = lightsIn(choose(map, {{"method", "stride"}})),
                                facing = lightsIn(choose(map, {{"method", "stride"}, {"area", "facing"}}));
  int lit = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    REQUIRE(facing[i].flux == surface[i].flux);
    if (surface[i].flux.x == 0.0f) continue;
    const bool isSun = i < 32 * 32;
    const glm::vec3 middle(snapshotOf(builder.scene, 0.0).origin);
    const glm::vec3 toLight = isSun
                                  ? glm::vec3(-1, 1, 0)
                                  : glm::vec3(0.2f, 0.7f, 0.1f) - middle - glm::vec3(surface[i].positionArea);
    const float cosine = glm::normalize(toLight).y;
    if (cosine < 0.05f) continue;  // where the map itself has no larger area
    REQUIRE(facing[i].positionArea.w == Approx(surface[i].positionArea.w * cosine).epsilon(1e-3));
    ++lit;
  }
  CHECK(lit > 1000);
}

TEST_CASE("no light is chosen of a dark map, and a map without areas is refused") {
  const std::vector<TakenLight> dark =
      lightsIn(choose(mapOf({{{0, 1, 0, 1}, {0, -1, 0, 1}, {0, 0, 0, 0}}}), {{"lights", 3.0}}));
  REQUIRE(dark.size() == 3);
  for (const TakenLight& light : dark) CHECK(light.flux == glm::vec4(0.0f));
  ReflectiveShadowMap map = mapOf({{{0, 1, 0, 1}, {0, -1, 0, 1}, {1, 1, 1, 0}}});
  map.normal = nullptr;
  CHECK_THROWS_MATCHES(choose(map, {}), Error, Tells("normals", "areas"));
  // A map of no light, as of a scene without one.
  map.lightCount = 0;
  CHECK(choose(map, {}).count == 0);
}
