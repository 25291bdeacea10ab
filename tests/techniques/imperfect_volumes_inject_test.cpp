// Direct light into the volume: what fragments made by hand leave in their voxels.
#include <cmath>

#include "lumivox/toolkit/light_samples.h"
#include "support/imperfect_volumes.h"
#include "support/made_fragments.h"
#include "support/phong_lobes.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

/// A light of 1 W/m^2 that travels along a direction and casts no shadows.
Scene sunAlong(const std::vector<glm::dvec3>& directions, const std::vector<float>& irradiances = {1.0f}) {
  SceneBuilder builder;
  builder.quad({-2, -2, -2}, {4, 0, 0}, {0, 4, 0}, builder.lambert(0.5f));
  for (std::size_t i = 0; i < directions.size(); ++i)
    builder.light(LightKind::directional, glm::vec3(irradiances[i % irradiances.size()]), {}, directions[i]);
  return builder.scene;
}
ShadowMap unshadowed(const Scene& scene) {
  LightSet set = sampleLights(scene, snapshotOf(scene, 0.0), 1, 4);
  for (LightSampleData& sample : set.samples) sample.firstView = -1;
  ShadowMap map;
  map.lightCount = static_cast<int>(set.samples.size());
  map.lights = bufferOf(set.samples);
  map.views = bufferOf<glm::mat4>({glm::mat4(0.0f)});
  map.depth = filled({gpu::TextureKind::d2Array, gpu::Format::depth32f}, glm::vec4(0.0f));
  return map;
}

ShGrid injected(const Scene& scene, const std::vector<FragmentData>& fragments, const Settings& settings = {},
                const glm::vec3& low = glm::vec3(0.0f)) {
  LonePass inject = volumePass("inject", scene);
  // A list over cells of a metre has voxels of half of one.
  inject.in("fragments", listOver({low, 1.0f, glm::ivec3(4)}, fragments))
      .in("shadow", unshadowed(scene))
      .with(settings);
  return inject.out<ShGrid>("reflected");
}

/// Flux of two bands through a side, over pi.
double sent(const ShGrid& light, const glm::ivec3& voxel, const glm::dvec3& normal) {
  return irradiance(coefficientsIn(light, voxel), normal) / kPi;
}

}  // namespace

TEST_CASE("a lit surface sends albedo E cos / pi from its lit side and none from the other, by either lobe") {
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.3, -0.2, -1.0)), normal(0, 0, 1);
  const double radiance = 0.5 * glm::dot(normal, -direction) / kPi;
  for (const bool fromBehind : {false, true}) {
    const glm::dvec3 lit = fromBehind ? -normal : normal;
    const Scene scene =
        sunAlong({fromBehind ? glm::dvec3(direction.x, direction.y, -direction.z) : direction});
    const std::vector<FragmentData> list{squareAt({1.25, 1.25, 1.25}, normal)};
    INFO((fromBehind ? "from behind" : "from the front"));
    for (const char* precision : {"float", "half"}) {
      const ShGrid light = injected(scene, list, {{"precision", precision}});
      CHECK(light.quantity == ShGrid::Quantity::radiance);
      CHECK(sent(light, {2, 2, 2}, lit) == Approx(radiance).epsilon(0.005));
      CHECK(std::abs(sent(light, {2, 2, 2}, -lit)) < 0.005 * radiance);
    }
    // A clamped cosine of the same flux: two bands let a sixteenth of it out backwards.
    const ShGrid light = injected(scene, list, {{"lobe", "cosine"}});
    CHECK(sent(light, {2, 2, 2}, lit) == Approx(radiance * 7.0 / 8.0).epsilon(0.005));
    CHECK(sent(light, {2, 2, 2}, -lit) == Approx(-radiance / 8.0).epsilon(0.005));
    CHECK(sent(light, {2, 2, 2}, lit) - sent(light, {2, 2, 2}, -lit) == Approx(radiance).epsilon(0.005));
    for (const float value : light.levels[0].coefficients[0]->downloadFloats(0)) CHECK(std::isfinite(value));
    CHECK(coefficientsIn(light, {3, 2, 2}) == glm::dvec4(0.0));
  }
}

TEST_CASE("a glossy surface in the volume also sends what its lobe reflects, unless lobes are left out") {
  // A fragment's word: three bytes of the Phong albedo, below the step of the exponent, here 2^(16 / 26 k)
  // - 1.
  constexpr std::uint32_t kSpecular = 128, kStep = 8;
  const double exponent = std::exp2((kStep - 1.0) * 16.0 / 26.0) - 1.0, specular = kSpecular / 255.0;
  for (const double cosine : {1.0, 0.5})
    for (const double side : {1.0, -1.0}) {
      Scene scene = sunAlong({{std::sqrt(1.0 - cosine * cosine), 0.0, -side * cosine}});
      scene.materials.front().specular = glm::vec3(0.5f);
      FragmentData square = squareAt({1.25, 1.25, 1.25}, {0, 0, 1});
      square.emission = kSpecular | kSpecular << 8 | kSpecular << 16 | kStep << 24;
      const double share = reflectedShare(exponent, cosine);
      for (const bool lobes : {true, false})
        CHECK(sent(injected(scene, {square}, {{"lobes", lobes ? "diffuse" : "none"}}), {2, 2, 2},
                   {0, 0, side}) ==
              Approx((0.5 + (lobes ? specular * share : 0.0)) * cosine / kPi).epsilon(0.01));
    }
}

TEST_CASE("direct light that fragments bring along is that of the side seen, and lights shine on the other") {
  // Two suns along the normal and against it: albedo / pi is 0.5 / pi of each. 192 / 256 W/(sr m^2) are
  // known.
  constexpr std::uint32_t kSeenBehind = 1u << 30;
  constexpr double kKnown = 0.75;
  const Scene scene = sunAlong({{0, 0, -1}, {0, 0, 1}}, {10.0f, 20.0f});
  const double front = 0.5 * 10.0 / kPi, back = 0.5 * 20.0 / kPi;
  for (const bool behind : {false, true})
    for (const bool lights : {true, false}) {
      CAPTURE(behind, lights);
      FragmentData square = squareAt({1.25, 1.25, 1.25}, {0, 0, 1});
      if (behind) square.offset |= kSeenBehind;
      VoxelFragments list = listOver({glm::vec3(0.0f), 1.0f, glm::ivec3(4)}, {square});
      list.reflected = bufferOf<std::uint32_t>({192u | 192u << 8 | 192u << 16 | 128u << 24});
      LonePass inject = volumePass("inject", scene);
      inject.in("fragments", list);
      if (lights) inject.in("shadow", unshadowed(scene));
      const ShGrid light = inject.out<ShGrid>("reflected");
      CHECK(sent(light, {2, 2, 2}, {0, 0, 1}) ==
            Approx(behind ? (lights ? front : 0.0) : kKnown).epsilon(0.005).margin(0.005));
      CHECK(sent(light, {2, 2, 2}, {0, 0, -1}) ==
            Approx(behind ? kKnown : (lights ? back : 0.0)).epsilon(0.005).margin(0.005));
    }
}

TEST_CASE("a volume lit by the image is the volume lit by the lights, voxel by voxel, on the Cornell box") {
  // Sec. 3.2: visible points take the light of the image; the lights are the same. Words have 8 bits a
  // channel, 1/256 of the largest; pixels whose light is partly specular differ, and the box is diffuse.
  const Scene scene = committed("cornell");
  const GBuffer gbuffer = gbufferOf(scene);
  const ShadowMap shadow = shadowsOf(scene);
  const auto reflected = [&](bool byImage) {
    LonePass voxels("voxelization.reproject", scene, {{"resolution", 32}});
    voxels.in("gbuffer", gbuffer);
    if (byImage)
      voxels.in("direct", LonePass("direct_lighting.shade", scene)
                              .in("gbuffer", gbuffer)
                              .in("shadow", shadow)
                              .out<Image>("radiance"));
    return LonePass("imperfect_volumes.inject", scene)
        .in("fragments", voxels.out<VoxelFragments>("fragments"))
        .in("shadow", shadow)
        .out<ShGrid>("reflected")
        .levels[0]
        .coefficients[1]
        ->downloadFloats(0);
  };
  const std::vector<float> lit = reflected(false), known = reflected(true);
  REQUIRE(lit.size() == known.size());
  double difference = 0.0, all = 0.0;
  for (std::size_t i = 0; i < lit.size(); i += 4) {
    difference += std::abs(lit[i] - known[i]);
    all += lit[i];
  }
  REQUIRE(all > 0.0);
  INFO("mean difference over mean: " << difference / all);
  CHECK(difference > 0.0);  // rounded to 8 bits: it was read
  CHECK(difference < 0.03 * all);
}

TEST_CASE("two sheets back to back keep two lights apart") {
  const Scene scene = sunAlong({{0, 0, -1}, {0, 0, 1}}, {1.0f, 100.0f});
  const ShGrid light =
      injected(scene, {squareAt({1.25, 1.25, 1.25}, {0, 0, 1}), squareAt({1.25, 1.25, 1.25}, {0, 0, -1})});
  CHECK(sent(light, {2, 2, 2}, {0, 0, 1}) == Approx(0.5 / kPi).epsilon(0.005));
  CHECK(sent(light, {2, 2, 2}, {0, 0, -1}) == Approx(50.0 / kPi).epsilon(0.005));
}

TEST_CASE(
    "a thousand equal fragments count as one, holes do not dim what is left, and twice gives the same bits") {
  const Scene scene = sunAlong({glm::normalize(glm::dvec3(-0.2, 0.5, -1.0))});
  const FragmentData one = squareAt({1.3, 1.1, 1.4}, {0.2f, 0.1f, 1.0f}, {0.9f, 0.5f, 0.1f});
  FragmentData holed = one;
  holed.albedoBCoverage = glm::packHalf2x16({0.1f, 0.25f});
  const ShGrid single = injected(scene, {one}), many = injected(scene, std::vector<FragmentData>(1000, one)),
               partly = injected(scene, {holed});
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const auto values = [&](const ShGrid& light) {
      return light.levels[0].coefficients[channel]->downloadFloats(0);
    };
    const std::vector<float> expected = values(single);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CHECK(values(many)[i] == Approx(expected[i]).epsilon(1e-5).margin(1e-7));
      CHECK(values(partly)[i] == Approx(expected[i]).epsilon(1e-5).margin(1e-7));
      if (i == 300) break;
    }
    // In any order: integers add up to the same.
    std::vector<FragmentData> list;
    for (int i = 0; i < 400; ++i)
      list.push_back(
          squareAt({0.1 + 0.0087 * i, 1.2, 1.3 + 0.003 * i}, {0.1f * static_cast<float>(i % 7), 1.0f, 0.3f}));
    const std::vector<float> forwards = values(injected(scene, list));
    std::reverse(list.begin(), list.end());
    CHECK(values(injected(scene, list)) == forwards);
  }
}

TEST_CASE("a dark voxel keeps its light beside one that is a million times brighter, in half floats too") {
  // Two spots half a metre above the floor, at x -0.6 and 0.6.
  const Scene scene = floorUnderTwoSpots(1e6f).scene;
  const glm::vec3 low(-1.0f, 0.0f, -1.0f);
  for (const char* precision : {"float", "half"}) {
    const ShGrid light =
        injected(scene, {squareAt({0.4, 0.001, 1.01}, {0, 1, 0}), squareAt({1.6, 0.001, 1.01}, {0, 1, 0})},
                 {{"precision", precision}}, low);
    INFO(precision << ", unit " << light.unit);
    CHECK((std::string(precision) == "half") == (light.unit != 1.0f));
    const double dark = sent(light, {0, 0, 2}, {0, 1, 0}), bright = sent(light, {3, 0, 2}, {0, 1, 0});
    CHECK(dark == Approx(0.5 / kPi / 0.25).epsilon(0.02));
    CHECK(bright == Approx(1e6 * dark).epsilon(0.01));
  }
}

TEST_CASE(
    "lights that touch both sides of a surface are no brighter than half a voxel away, in half floats too") {
  SceneBuilder builder;
  builder.quad({-2, -2, -2}, {4, 0, 0}, {0, 4, 0}, builder.lambert(0.5f));
  for (const double z : {1.2, 1.3}) builder.light(LightKind::point, glm::vec3(10.0f), {1.25, 1.25, z});
  // Voxels of half a metre: both lights together a quarter of a metre away.
  const double most = 2.0 * 10.0 / (0.25 * 0.25) / kPi;
  const glm::vec3 low = -glm::vec3(snapshotOf(builder.scene, 0.0).origin);
  for (const char* precision : {"float", "half"}) {
    const ShGrid light =
        injected(builder.scene, {squareAt({1.25, 1.25, 1.25}, {0, 0, 1})}, {{"precision", precision}}, low);
    CAPTURE(precision);
    for (const double side : {-1.0, 1.0})
      CHECK(sent(light, {2, 2, 2}, {0, 0, side}) == Approx(most).epsilon(0.002));
  }
}

TEST_CASE("each colour of a surface leaves its lit side in the volume of that colour") {
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.3, -0.2, -1.0)), normal(0.0, 0.6, 0.8);
  const glm::vec3 albedo(0.9f, 0.5f, 0.1f);
  const ShGrid light = injected(sunAlong({direction}), {squareAt({1.25, 1.25, 1.25}, normal, albedo)});
  const glm::ivec3 size = light.levels[0].grid.resolution;
  for (int c = 0; c < 3; ++c) {
    const std::vector<float> values =
        light.levels[0].coefficients[static_cast<std::size_t>(c)]->downloadFloats(0);
    const auto i = static_cast<std::size_t>(4 * ((2 * size.y + 2) * size.x + 2));
    const glm::dvec4 found(values[i], values[i + 1], values[i + 2], values[i + 3]);
    const double radiance = double{albedo[c]} * glm::dot(normal, -direction) / kPi;
    CAPTURE(c);
    CHECK(irradiance(found, normal) / kPi == Approx(radiance).epsilon(0.01));
    CHECK(std::abs(irradiance(found, -normal)) / kPi < 0.01 * radiance);
  }
}
