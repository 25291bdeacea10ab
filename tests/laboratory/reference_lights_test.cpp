// Direct light against closed forms: a Lambert surface of albedo a that receives the irradiance E sends out
// the radiance a E / pi.
#include <array>

#include "lumivox/base/random.h"
#include "lumivox/reference/path_tracer.h"
#include "reference/sampling.h"
#include "support/placed.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr float kAlbedo = 0.6f;

/// A floor at height zero, facing up.
SceneBuilder floorOnly(float albedo = kAlbedo) {
  SceneBuilder builder;
  builder.quad({-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, builder.lambert(albedo));
  return builder;
}

/// Radiance of the floor at (x, 0, z), seen steeply from above.
double floorRadiance(const Scene& scene, double x, double z, int samples, int bounces = 0) {
  return referenceRadiance(scene, 0.0, {x + 0.02, 0.1, z - 0.01}, {-0.02f, -0.1f, 0.01f},
                           quietly(samples, bounces))
      .y;
}

/// A white square metre of a texture, u along x and v along y, under a light of 1 W/m^2 along -z.
Scene texturedSheet(const SurfaceTexture& texture) {
  SceneBuilder builder;
  builder.scene.textures.push_back(texture);
  Material material;
  material.diffuse = glm::vec3(1.0f);
  material.diffuseTexture = 0;
  builder.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, builder.material(material));
  builder.light(LightKind::directional, glm::vec3(1.0f), {}, {0, 0, -1});
  return builder.scene;
}
glm::dvec3 sheetAlbedo(const Scene& scene, double x, double y) {
  return kPi * glm::dvec3(referenceRadiance(scene, 0.0, {x, y, 1.0}, {0, 0, -1}, quietly(1)));
}

/// Irradiance on a plane with unit `normal` at `point` by a polygon of uniform radiance 1 that lies wholly
/// above the plane. Lambert 1760: E = 1/2 sum over the edges of the angle that the edge subtends, times the
/// cosine between the plane's normal and the normal of the triangle that point and edge span.
double polygonIrradiance(const std::vector<glm::dvec3>& corners, const glm::dvec3& point,
                         const glm::dvec3& normal) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::normalize(corners[i] - point),
                     b = glm::normalize(corners[(i + 1) % corners.size()] - point);
    sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(glm::cross(a, b)), normal);
  }
  return 0.5 * std::abs(sum);
}

}  // namespace

TEST_CASE("a Lambert plane under a directional light returns a E cos / pi within 0.1 %") {
  for (const double angle : {0.0, 0.5, 1.0, 1.4}) {
    CAPTURE(angle);
    SceneBuilder builder = floorOnly();
    builder.light(LightKind::directional, glm::vec3(3.0f), {}, {std::sin(angle), -std::cos(angle), 0.0});
    CHECK(floorRadiance(builder.scene, 1.0, 2.0, 1) ==
          Approx(kAlbedo * 3.0 * std::cos(angle) / kPi).epsilon(0.001));
  }
}

TEST_CASE("a Lambert plane under a point light returns a I cos / (pi d^2) within 0.1 %") {
  SceneBuilder builder = floorOnly();
  builder.light(LightKind::point, glm::vec3(7.0f), {0, 2, 0});
  for (const double x : {0.0, 0.5, 3.0, 20.0}) {
    CAPTURE(x);
    const double squaredDistance = x * x + 4.0, cosine = 2.0 / std::sqrt(squaredDistance);
    CHECK(floorRadiance(builder.scene, x, 0.0, 1) ==
          Approx(kAlbedo * 7.0 * cosine / (kPi * squaredDistance)).epsilon(0.001));
  }
}

TEST_CASE("both sides of a surface reflect, each only its own side's light") {
  SceneBuilder builder = floorOnly();
  builder.light(LightKind::point, glm::vec3(1.0f), {0, -1, 0});
  CHECK(floorRadiance(builder.scene, 0.0, 0.0, 1) == 0.0);
  const double below = referenceRadiance(builder.scene, 0.0, {0, -0.5, 0}, {0, 1, 0}, quietly(1)).x;
  CHECK(below == Approx(kAlbedo / kPi).epsilon(0.001));
}

TEST_CASE("a spot light falls off by smoothstep of the cosine between its two angles") {
  SceneBuilder builder = floorOnly();
  Light& spot = builder.light(LightKind::spot, glm::vec3(5.0f), {0, 3, 0});
  spot.innerAngle = 0.2f;
  spot.outerAngle = 0.5f;
  for (const double angle : {0.0, 0.15, 0.25, 0.35, 0.45, 0.55}) {
    CAPTURE(angle);
    const double t =
        std::clamp((std::cos(angle) - std::cos(0.5)) / (std::cos(0.2) - std::cos(0.5)), 0.0, 1.0);
    const double intensity = 5.0 * t * t * (3.0 - 2.0 * t), distance = 3.0 / std::cos(angle);
    const double expected = kAlbedo * intensity * std::cos(angle) / (kPi * distance * distance);
    CHECK(floorRadiance(builder.scene, 3.0 * std::tan(angle), 0.0, 1) ==
          Approx(expected).epsilon(0.001).margin(1e-6));
  }
}

TEST_CASE("many lights of very different power add up") {
  SceneBuilder builder = floorOnly();
  builder.light(LightKind::directional, glm::vec3(1.0f), {}, {0, -1, 0});
  builder.light(LightKind::point, glm::vec3(0.02f), {0, 0.5, 0});
  Light& spot = builder.light(LightKind::spot, glm::vec3(4.0f), {0, 2, 0});
  spot.innerAngle = 0.3f, spot.outerAngle = 0.4f;
  const double irradiance = 1.0 + 0.02 / 0.25 + 4.0 / 4.0;
  CHECK(floorRadiance(builder.scene, 0.0, 0.0, 200000) == Approx(kAlbedo * irradiance / kPi).epsilon(0.01));
}

TEST_CASE("a quad light over a point gives Lambert's polygon formula within 0.5 %") {
  const glm::vec3 corner(-0.5f, 1.0f, -0.3f), edge1(1.0f, 0, 0), edge2(0, 0, 0.8f);  // front side: down
  SceneBuilder builder = floorOnly();
  builder.quad(corner, edge1, edge2, builder.lambert(0.0f, 2.5f));
  const std::vector<glm::dvec3> polygon = {corner, corner + edge1, corner + edge1 + edge2, corner + edge2};
  for (const glm::dvec2 place : {glm::dvec2(0.0, 0.1), glm::dvec2(1.5, 0.4), glm::dvec2(-3.0, 2.0)}) {
    CAPTURE(place.x, place.y);
    const double irradiance = 2.5 * polygonIrradiance(polygon, {place.x, 0, place.y}, {0, 1, 0});
    CHECK(floorRadiance(builder.scene, place.x, place.y, 200000) ==
          Approx(kAlbedo * irradiance / kPi).epsilon(0.005));
  }
}

TEST_CASE("a point a millimetre under a large area light is right within 0.5 %") {
  const glm::vec3 corner(-1.0f, 0.001f, -1.0f), edge1(2.0f, 0, 0), edge2(0, 0, 2.0f);
  SceneBuilder builder = floorOnly();
  builder.quad(corner, edge1, edge2, builder.lambert(0.0f, 1.0f));
  const double irradiance = polygonIrradiance(
      {corner, corner + edge1, corner + edge1 + edge2, corner + edge2}, {0.3, 0, 0.2}, {0, 1, 0});
  const double radiance =
      referenceRadiance(builder.scene, 0.0, {0.3, 0.0005, 0.2}, {0, -1, 0}, quietly(100000, 0)).x;
  CHECK(radiance == Approx(kAlbedo * irradiance / kPi).epsilon(0.005));
}

TEST_CASE("an emissive surface shines from its front side only") {
  SceneBuilder builder = floorOnly();
  builder.quad({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, builder.lambert(0.0f, 2.0f));  // faces down
  const auto seen = [&](double height, float direction) {
    return referenceRadiance(builder.scene, 0.0, {0, height, 0}, {0, direction, 0}, quietly(16, 0)).x;
  };
  CHECK(seen(0.5, 1.0f) == 2.0);
  CHECK(seen(2.0, -1.0f) == 0.0);
  // Mirrored as a whole it still shines away from the same side of the surface: now upwards.
  place(builder.scene, builder.scene.objects.back(), {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 2, 0, 1});
  CHECK(seen(0.5, 1.0f) == 0.0);
  CHECK(seen(2.0, -1.0f) == 2.0);
}

TEST_CASE("the form factors of unit squares are right within 0.5 %") {
  // A white receiver under an emitter of radiance 1 sends out E / pi, whose mean over the receiver is the
  // form factor from receiver to emitter. The camera stands half a metre over the receiver with a right angle
  // of view: the square fills the image, and the projection of a parallel plane is uniform, so the mean
  // over the pixels is the mean over the square.
  // Howell, "A catalog of radiation heat transfer configuration factors": parallel, one edge length apart,
  // C-11 with X = Y = 1: F = 2/pi (ln sqrt(4/3) + 2 sqrt(2) atan(1/sqrt(2)) - 2 atan(1)) = 0.19982;
  // perpendicular with a common edge, C-14 with H = W = 1: F = 1/pi (2 atan(1) - sqrt(2) atan(1/sqrt(2)) +
  // 1/4 ln(4/3 (3/4)^2)) = 0.20004.
  const bool parallel = GENERATE(true, false);
  const double slanted = std::sqrt(2.0) * std::atan(1.0 / std::sqrt(2.0));
  const double expected = parallel ? 2.0 / kPi * (0.5 * std::log(4.0 / 3.0) + 2.0 * slanted - 0.5 * kPi)
                                   : 1.0 / kPi * (0.5 * kPi - slanted + 0.25 * std::log(0.75));
  CHECK(expected == Approx(parallel ? 0.19982 : 0.20004).epsilon(1e-4));
  SceneBuilder builder;
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, builder.lambert(1.0f));
  const int emitter = builder.lambert(0.0f, 1.0f);
  if (parallel)
    builder.quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, emitter);
  else
    builder.quad({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, emitter);
  builder.look({0.5, 0.5, 0.5}, {0.5, 0, 0.5}, {0, 0, 1}, 0.5 * kPi, 32, 32);
  const Estimate direct = estimateOf(renderReference(builder.scene, quietly(512, 0)), "direct");
  CHECK(direct.deviation < 0.0015 * expected);
  CHECK(direct.mean == Approx(expected).epsilon(0.005));
}

TEST_CASE("masks let light and sight through their holes, and cut area lights") {
  SurfaceTexture mask;
  mask.mask = true;
  mask.width = 2, mask.height = 1;
  mask.values = {1.0f, 0.0f};  // the half with texture coordinate u below 0.5 is there, the other is a hole
  const auto floorUnder = [&](float emission, float side) {
    SceneBuilder builder = floorOnly();
    builder.scene.textures.push_back(mask);
    Material cut;
    cut.maskTexture = 0;
    cut.emission = glm::vec3(emission);
    builder.quad({-0.5f * side, 1, -0.5f * side}, {side, 0, 0}, {0, 0, side}, builder.material(cut));
    return builder;
  };
  SceneBuilder sheet = floorUnder(0.0f, 2.0f);
  sheet.light(LightKind::directional, glm::vec3(1.0f), {}, {0, -1, 0});
  CHECK(floorRadiance(sheet.scene, -0.5, 0.0, 1) == 0.0);
  CHECK(floorRadiance(sheet.scene, 0.5, 0.0, 1) == Approx(kAlbedo / kPi).epsilon(0.001));
  const auto fromAbove = [&](double x) {
    return referenceRadiance(sheet.scene, 0.0, {x, 2, 0}, {0, -1, 0}, quietly(1)).x;
  };
  CHECK(fromAbove(-0.5) == 0.0);  // the masked half is black
  CHECK(fromAbove(0.5) == Approx(kAlbedo / kPi).epsilon(0.001));
  // Half an area light gives the light of an area light of half the size.
  const double irradiance =
      3.0 *
      polygonIrradiance({{-0.5, 1, -0.5}, {0, 1, -0.5}, {0, 1, 0.5}, {-0.5, 1, 0.5}}, {0.2, 0, 0}, {0, 1, 0});
  CHECK(floorRadiance(floorUnder(3.0f, 1.0f).scene, 0.2, 0.0, 1000000) ==
        Approx(kAlbedo * irradiance / kPi).epsilon(0.005));
}

TEST_CASE("a diffuse texture is read bilinearly, repeats, and has its first row at the top") {
  const auto [u, v, albedo] = GENERATE(table<double, double, double>({
      {0.25, 0.75, 0.1},
      {0.75, 0.75, 0.3},
      {0.25, 0.25, 0.5},
      {0.75, 0.25, 0.9},
      {0.5, 0.5, 0.45},
      {0.4, 0.75, 0.16},
      {1.75, -0.25, 0.3},
  }));
  SurfaceTexture texture;
  texture.width = texture.height = 2;
  texture.values = {0.1f, 0.1f, 0.1f, 0.3f, 0.3f, 0.3f, 0.5f, 0.5f, 0.5f, 0.9f, 0.9f, 0.9f};
  Scene scene = texturedSheet(texture);
  for (glm::vec2& texcoord : scene.texcoords) texcoord = 3.0f * texcoord - 1.0f;
  CAPTURE(u, v);
  CHECK(sheetAlbedo(scene, (u + 1.0) / 3.0, (v + 1.0) / 3.0).x == Approx(albedo).epsilon(0.001));
}

TEST_CASE("a texture of more than 256 different values keeps every one of them") {
  SurfaceTexture texture;
  texture.width = 30, texture.height = 20;
  for (int i = 0; i < 3 * 30 * 20; ++i) texture.values.push_back(static_cast<float>(i) / 1800.0f);
  const Scene scene = texturedSheet(texture);
  for (const glm::ivec2 texel : {glm::ivec2(0, 0), glm::ivec2(29, 19), glm::ivec2(17, 11)}) {
    CAPTURE(texel.x, texel.y);
    const glm::dvec3 albedo = sheetAlbedo(scene, (texel.x + 0.5) / 30.0, 1.0 - (texel.y + 0.5) / 20.0);
    for (int channel = 0; channel < 3; ++channel)
      CHECK(albedo[channel] ==
            Approx(texture.values[static_cast<std::size_t>(3 * (30 * texel.y + texel.x) + channel)])
                .margin(1e-4));
  }
}

TEST_CASE("among a million weights the alias table picks each in its proportion, however small") {
  // Every other weight is a hundred-thousandth of its neighbour. With 20 bits spent on the choice of a slot,
  // the 12 that a single number of 32 bits leaves would take the small index in 1 of 4096 cases at least.
  constexpr std::size_t kCount = std::size_t{1} << 20;
  constexpr double kSmall = 1e-5;
  std::vector<double> weights(kCount, 1.0);
  for (std::size_t i = 0; i < kCount; i += 2) weights[i] = kSmall;
  const reference::AliasTable table(weights);
  RandomStream random(7, 1);
  constexpr int kDraws = 1 << 25;
  int small = 0;
  for (int i = 0; i < kDraws; ++i) {
    const std::uint32_t slot = random.bits(), choice = random.bits();
    small += table.pick(slot, choice) % 2 == 0 ? 1 : 0;
  }
  const double expected = kDraws * kSmall / (1.0 + kSmall);
  CHECK(std::abs(small - expected) < 4.0 * std::sqrt(expected));
}
