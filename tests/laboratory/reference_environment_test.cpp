// Environment maps in the reference, against closed forms.
#include <glm/gtc/matrix_transform.hpp>

#include "lumivox/base/log.h"
#include "lumivox/reference/path_tracer.h"
#include "reference/cache.h"
#include "reference/environment.h"
#include "reference/kept.h"
#include "support/environment_maps.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

EnvironmentMap constantMap(float radiance, int height = 16) {
  return environmentOf(height, [&](const glm::vec3&) { return glm::vec3(radiance); });
}

/// A large square through the origin with this normal, alone.
Scene facing(const glm::vec3& normal, float albedo) {
  SceneBuilder builder;
  const glm::vec3 side = glm::normalize(glm::cross(
                      normal, std::abs(normal.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0))),
                  other = glm::cross(normal, side);
  builder.quad(-50.0f * (side + other), 100.0f * side, 100.0f * other, builder.lambert(albedo));
  return builder.scene;
}

double reflected(const Scene& scene, const glm::vec3& normal, int samples) {
  return referenceRadiance(scene, 0.0, glm::dvec3(normal) + glm::dvec3(0.01, 0.02, 0.03), -normal,
                           quietly(samples))
      .y;
}

/// A box on a floor under the sky, with a camera.
SceneBuilder boxOnFloor() {
  SceneBuilder builder;
  builder.quad({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, builder.lambert(0.6f));
  builder.box({-0.5f, 0.0f, -0.5f}, {0.5f, 1.0f, 0.5f}, builder.lambert(0.5f), false);
  builder.look({3, 2.5, 4}, {0, 0.3, 0}, {0, 1, 0}, 0.7, 24, 24);
  return builder;
}

double meanVariance(const LayeredImage& image, const char* layer) {
  const ImageBuffer& variances = image.layers.at(std::string(layer) + ".variance");
  double sum = 0.0;
  for (const float value : variances.values()) sum += value;
  return sum / static_cast<double>(variances.values().size());
}

}  // namespace

TEST_CASE(
    "a ray that misses sees the texel in its direction: up, down, and -Z in the middle with +X to its right") {
  // Six spots, each of a colour of its own.
  const auto spot = [](const glm::vec3& d) {
    const glm::vec3 size = glm::abs(d);
    const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    glm::vec3 colour(0.0f);
    colour[axis] = d[axis] > 0.0f ? 1.0f : 2.0f;
    return size[axis] > 0.9f ? colour : glm::vec3(0.0f);
  };
  EnvironmentMap map = environmentOf(32, spot);
  // In the image itself: the upper row is +Y, the middle column -Z, and +X three quarters of the way.
  const auto at = [&](int column, int row) {
    return map.radiance[static_cast<std::size_t>(row * map.width + column)];
  };
  CHECK(at(5, 0) == glm::vec3(0, 1, 0));
  CHECK(at(40, 31) == glm::vec3(0, 2, 0));
  CHECK(at(32, 16) == glm::vec3(0, 0, 2));
  CHECK(at(48, 16) == glm::vec3(1, 0, 0));
  CHECK(at(16, 16) == glm::vec3(2, 0, 0));
  CHECK(at(0, 16) == glm::vec3(0, 0, 1));

  Scene scene = facing({0, 1, 0}, 0.5f);
  shineFrom(scene, map);
  const auto seen = [&](const glm::vec3& direction) {
    return referenceRadiance(scene, 0.0, {0, 1000, 0}, direction, quietly(1));
  };
  for (const glm::vec3 d : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1),
                            glm::vec3(0, 0, -1), glm::vec3(0.1f, 0.05f, -1.0f)})
    CHECK(seen(d) == spot(glm::normalize(d)));
  // Turned by a quarter about +Y, what was at -Z is at -X (right-handed).
  map.toMap = glm::mat3(glm::transpose(glm::rotate(glm::dmat4(1.0), 0.5 * kPi, glm::dvec3(0, 1, 0))));
  shineFrom(scene, map);
  CHECK(seen({-1, 0, 0}) == glm::vec3(0, 0, 2));
  CHECK(seen({0, 0, -1}) == glm::vec3(1, 0, 0));
  CHECK(seen({0, 1, 0}) == glm::vec3(0, 1, 0));
}

TEST_CASE("the solid angles of a map's texels add up to the sphere, and its points lie in their texels") {
  const EnvironmentMap map = constantMap(1.0f, 13);
  double sum = 0.0;
  for (int row = 0; row < map.height; ++row) sum += map.width * map.solidAngle(row);
  CHECK(sum == Approx(4.0 * kPi).epsilon(1e-12));
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column)
      for (const float u : {0.01f, 0.5f, 0.99f})
        CHECK(map.texelTowards(map.directionWithin(column, row, u, 1.0f - u)) ==
              static_cast<std::size_t>(row * map.width + column));
}

TEST_CASE("a map of one value lights a convex surface and a furnace as the constant does, within 0.2 %") {
  Scene scene = facing(glm::normalize(glm::vec3(1, 2, 3)), 0.6f);
  shineFrom(scene, constantMap(2.0f));
  CHECK(reflected(scene, glm::normalize(glm::vec3(1, 2, 3)), 500000) == Approx(1.2).epsilon(0.002));

  // An open box inside: the light of the map and of bounces adds up to the same radiance everywhere if
  // nothing is absorbed.
  SceneBuilder furnace = boxOnFloor();
  for (Material& material : furnace.scene.materials) material.diffuse = glm::vec3(1.0f);
  shineFrom(furnace.scene, constantMap(2.0f));
  ReferenceOptions options = quietly(256, 200);
  options.roulette = false;
  const Estimate full = estimateOf(renderReference(furnace.scene, options), "full");
  CHECK(full.mean == Approx(2.0).epsilon(0.002));
  CHECK(full.deviation < 0.002);
}

TEST_CASE(
    "a map of one band of spherical harmonics lights surfaces by its cosine-convolved coefficients within 0.2 %") {
  // L = 1 + 0.8 d.s: E = pi + 0.8 (2 pi / 3) n.s (Ramamoorthi and Hanrahan 2001, Eq. 8).
  const glm::vec3 s = glm::normalize(glm::vec3(0.3f, 0.8f, -0.5f));
  const EnvironmentMap map =
      environmentOf(64, [&](const glm::vec3& d) { return glm::vec3(1.0f + 0.8f * glm::dot(d, s)); });
  for (const glm::vec3 direction : {glm::vec3(0, 1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1),
                                    glm::vec3(1, 1, -1), glm::vec3(-1, -2, 1)}) {
    const glm::vec3 normal = glm::normalize(direction);
    CAPTURE(normal.x, normal.y, normal.z);
    Scene scene = facing(normal, 1.0f);
    shineFrom(scene, map);
    const double expected = 1.0 + 0.8 * 2.0 / 3.0 * glm::dot(normal, s);
    CHECK(reflected(scene, normal, 100000) == Approx(expected).epsilon(0.002));
  }
}

TEST_CASE("a sun of 10^5 in four texels converges as the same sun does as a directional light") {
  const int height = 64;
  EnvironmentMap map = environmentOf(height, [](const glm::vec3&) { return glm::vec3(0.0f); });
  const int row = 20, column = 90;
  glm::dvec3 towards(0.0);
  double irradiance = 0.0;  // on a plane that faces the sun
  for (const int y : {row, row + 1})
    for (const int x : {column, column + 1}) {
      map.radiance[static_cast<std::size_t>(y * map.width + x)] = glm::vec3(1e5f);
      irradiance += 1e5 * map.solidAngle(y);
      towards += glm::dvec3(map.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
    }
  map.finish();
  SceneBuilder sun = boxOnFloor(), directional = boxOnFloor();
  shineFrom(sun.scene, map);
  directional.light(LightKind::directional, glm::vec3(static_cast<float>(irradiance)), {}, -towards);
  const LayeredImage byMap = renderReference(sun.scene, quietly(128, 8)),
                     byLight = renderReference(directional.scene, quietly(128, 8));
  const double most = 2.0 * meanVariance(byLight, "full");
  INFO("variances of the pixel: " << meanVariance(byMap, "full") << " and " << meanVariance(byLight, "full"));
  // The sun is no point: its shadow has a soft edge. Camera rays that meet the sun itself are left out by the
  // view downwards.
  CHECK(meanVariance(byMap, "full") < most);
  CHECK(estimateOf(byMap, "full").mean == Approx(estimateOf(byLight, "full").mean).epsilon(0.01));
}

TEST_CASE(
    "light of a map counts as one bounce, and its own layers are the part that nothing else reflected") {
  const bool constant = GENERATE(true, false);
  SceneBuilder builder = boxOnFloor();
  if (constant) {
    builder.scene.environment = glm::vec3(1.0f);
  } else {
    shineFrom(builder.scene,
              environmentOf(16, [](const glm::vec3& d) { return glm::vec3(1.0f + 0.9f * d.x); }));
  }
  builder.scene.materials[1].specular = glm::vec3(0.3f);
  builder.scene.materials[1].exponent = 8.0f;
  // Without another light: all that arrives after one bounce comes straight from there.
  const LayeredImage alone = renderReference(builder.scene, quietly(16, 4));
  CHECK(alone.layers.at("environment_diffuse").values() == alone.layers.at("one_bounce_diffuse").values());
  CHECK(alone.layers.at("environment_glossy").values() == alone.layers.at("one_bounce_glossy").values());
  CHECK(estimateOf(alone, "environment_glossy").mean > 0.001);
  const Estimate further = estimateOf(alone, "indirect_diffuse"),
                 first = estimateOf(alone, "environment_diffuse");
  CHECK(further.mean > first.mean + 3.0 * (further.deviation + first.deviation));
  // With no bounce at all there is none of it.
  const LayeredImage none = renderReference(builder.scene, quietly(4, 0));
  CHECK(estimateOf(none, "indirect_diffuse").mean == 0.0);
  CHECK(estimateOf(none, "environment").mean == 0.0);

  // A lamp beside it adds nothing to these layers.
  builder.light(LightKind::point, glm::vec3(500.0f), {0, 2, 0});
  const LayeredImage both = renderReference(builder.scene, quietly(1024, 1));
  const Estimate environment = estimateOf(both, "environment"),
                 oneBounce = estimateOf(both, "one_bounce_diffuse");
  const Estimate before = estimateOf(renderReference(
                                         [&] {
                                           Scene scene = builder.scene;
                                           scene.lights.clear();
                                           return scene;
                                         }(),
                                         quietly(1024, 1)),
                                     "environment");
  CHECK(environment.mean == Approx(before.mean).margin(4.0 * (environment.deviation + before.deviation)));
  CHECK(oneBounce.mean > environment.mean + 4.0 * (environment.deviation + oneBounce.deviation));
  // A scene without an environment has no such layers.
  builder.scene.environment = glm::vec3(0.0f);
  builder.scene.environmentMap = nullptr;
  CHECK(renderReference(builder.scene, quietly(2, 1)).layers.count("environment") == 0);
}

TEST_CASE("layers of numbers of bounces count the light of a map as the others do") {
  SceneBuilder builder = boxOnFloor();
  shineFrom(builder.scene,
            environmentOf(16, [](const glm::vec3& d) { return glm::vec3(1.0f + 0.9f * d.x); }));
  ReferenceOptions options = quietly(16, 6);
  options.bounceLayers = {1, 6};
  const LayeredImage image = renderReference(builder.scene, options);
  const auto same = [&](const char* a, const char* b) {
    const auto &x = image.layers.at(a).values(), &y = image.layers.at(b).values();
    for (std::size_t i = 0; i < x.size(); ++i) REQUIRE(x[i] == Approx(y[i]).epsilon(1e-5).margin(1e-7));
  };
  same("bounces_1_diffuse", "one_bounce_diffuse");
  same("bounces_6_diffuse", "indirect_diffuse");
  same("bounces_6", "full");
}

TEST_CASE(
    "a medium that absorbs nothing leaves a map of one value as it is, and scatters the light of the bright side") {
  SceneBuilder builder = boxOnFloor();
  for (Material& material : builder.scene.materials) material.diffuse = glm::vec3(1.0f);
  Medium mist;
  mist.name = "mist";
  mist.extinction = glm::vec3(0.7f);
  mist.albedo = glm::vec3(1.0f);
  mist.anisotropy = 0.4f;
  mist.box = {glm::dvec3(-2.0), glm::dvec3(2.0)};
  builder.scene.media.push_back(mist);
  shineFrom(builder.scene, constantMap(2.0f));
  ReferenceOptions options = quietly(256, 200);
  options.roulette = false;
  const Estimate full = estimateOf(renderReference(builder.scene, options), "full");
  CHECK(full.mean == Approx(2.0).epsilon(0.005));

  // A thin medium alone, g = 0, before a sky that shines from one half: single scattering brings half of the
  // constant's.
  SceneBuilder thin;
  mist.extinction = glm::vec3(0.01f);
  mist.anisotropy = 0.0f;
  mist.box = {glm::dvec3(-0.5), glm::dvec3(0.5)};
  thin.scene.media.push_back(mist);
  const auto scattered = [&](const EnvironmentMap& map) {
    shineFrom(thin.scene, map);
    thin.look({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.2, 4, 4);
    return estimateOf(renderReference(thin.scene, quietly(100000, 4)), "scattered").mean;
  };
  const double half =
      scattered(environmentOf(16, [](const glm::vec3& d) { return glm::vec3(d.y > 0.0f ? 2.0f : 0.0f); }));
  CHECK(half == Approx(0.01).epsilon(0.03));  // albedo sigma l 2 / 2, of a length of 1 m
}

TEST_CASE("a reference with an environment is kept and found again") {
  SceneBuilder builder = boxOnFloor();
  const bool constant = GENERATE(true, false);
  if (constant) {
    builder.scene.environment = glm::vec3(1.0f);
  } else {
    shineFrom(builder.scene,
              environmentOf(8, [](const glm::vec3& d) { return glm::vec3(1.0f + 0.9f * d.x); }));
  }
  ReferenceOptions options = quietly(2, 2);
  options.useCache = true;
  options.seed = 4711;
  const LayeredImage made = cachedReference(builder.scene, options);
  CHECK(reference::isKept(builder.scene, options));
  const LogCapture log;
  const LayeredImage found = cachedReference(builder.scene, options);
  CHECK(log.text() == "");
  CHECK(found.layers.at("environment").values() == made.layers.at("environment").values());
}

TEST_CASE("one texel more of light makes another reference") {
  SceneBuilder builder = boxOnFloor();
  EnvironmentMap map = constantMap(1.0f);
  const auto key = [&] {
    return reference::cacheKey(builder.scene, reference::resolve(builder.scene, quietly(2)));
  };
  shineFrom(builder.scene, map);
  const ContentHash before = key();
  map.radiance[5].y *= 2.0f;
  map.radiance[6].y = 0.0f;
  map.finish();
  const glm::vec3 mean = builder.scene.environment;
  shineFrom(builder.scene, map);
  builder.scene.environment = mean;
  CHECK(!(key() == before));
}
