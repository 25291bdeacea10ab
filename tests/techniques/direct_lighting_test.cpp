#include <glm/gtc/constants.hpp>

#include "support/form_factors.h"
#include "support/placed.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::WithinRel;

namespace {

/// A floor of 2 m x 2 m at y = 0 facing up, seen from 3 m above; `up` of the image is -z.
SceneBuilder floorFromAbove(float albedo, int pixels) {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(albedo));
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 2.0 * std::atan(1.0 / 3.0), pixels, pixels);
  return builder;
}

ImageBuffer direct(const Scene& scene, RenderOptions options = {}) {
  return renderOnce(scene, pipeline("direct_lighting"), options).outputs.at("direct");
}

/// Where the centre of a pixel of floorFromAbove lies on the floor.
glm::vec3 floorPoint(int x, int y, int pixels) {
  return {2.0f * (static_cast<float>(x) + 0.5f) / static_cast<float>(pixels) - 1.0f, 0.0f,
          2.0f * (static_cast<float>(y) + 0.5f) / static_cast<float>(pixels) - 1.0f};
}

}  // namespace

TEST_CASE(
    "a Lambert plane under a directional light reflects albedo / pi times irradiance times the cosine") {
  SceneBuilder builder = floorFromAbove(0.5f, 16);
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.3, -1.0, 0.2));
  builder.light(LightKind::directional, {3, 2, 1}, {}, direction);
  const ImageBuffer image = direct(builder.scene);
  const double cosine = -direction.y;
  for (int c = 0; c < 3; ++c) {
    const double expected = 0.5 / glm::pi<double>() * (3 - c) * cosine;
    CHECK_THAT(image.at(3, 11, c), WithinRel(static_cast<float>(expected), 1e-3f));
    CHECK_THAT(image.at(12, 4, c), WithinRel(static_cast<float>(expected), 1e-3f));
  }
}

TEST_CASE("a Lambert plane under a point light falls off with the squared distance and the cosine") {
  SceneBuilder builder = floorFromAbove(0.8f, 16);
  const glm::vec3 light(0.2f, 1.0f, -0.3f);
  builder.light(LightKind::point, {10, 10, 10}, light);
  const ImageBuffer image = direct(builder.scene);
  for (const glm::ivec2 pixel : {glm::ivec2(2, 2), glm::ivec2(8, 8), glm::ivec2(14, 3)}) {
    const glm::vec3 path = light - floorPoint(pixel.x, pixel.y, 16);
    const float distance = glm::length(path);
    const float expected = 0.8f / glm::pi<float>() * 10.0f * (path.y / distance) / (distance * distance);
    CHECK_THAT(image.at(pixel.x, pixel.y, 1), WithinRel(expected, 1e-3f));
  }
}

TEST_CASE("a light in the very point that is seen lights it no more than any other point of its plane") {
  // Of an odd number of pixels the middle one sees the middle of the floor.
  SceneBuilder builder = floorFromAbove(0.8f, 5);
  for (const LightKind kind : {LightKind::point, LightKind::spot}) {
    builder.scene.lights.clear();
    Light& light = builder.light(kind, {10, 10, 10}, {0, 0, 0}, {0, -1, 0});
    light.innerAngle = 1.0f;
    light.outerAngle = 1.5f;
    const ImageBuffer image = direct(builder.scene);
    for (const float radiance : image.values()) CHECK(radiance == 0.0f);
  }
}

TEST_CASE("a spot light keeps its intensity inside the inner angle and is dark outside the outer one") {
  SceneBuilder builder = floorFromAbove(1.0f, 32);
  Light& spot = builder.light(LightKind::spot, {5, 5, 5}, {0, 1, 0}, {0, -1, 0});
  spot.innerAngle = glm::radians(20.0f);
  spot.outerAngle = glm::radians(30.0f);
  const ImageBuffer image = direct(builder.scene);
  for (int x = 0; x < 32; ++x) {
    const glm::vec3 path = glm::vec3(0, 1, 0) - floorPoint(x, 16, 32);
    const float distance = glm::length(path), cosine = path.y / distance;
    const float t = glm::clamp(
        (cosine - std::cos(spot.outerAngle)) / (std::cos(spot.innerAngle) - std::cos(spot.outerAngle)), 0.0f,
        1.0f);
    const float expected =
        5.0f / glm::pi<float>() * cosine / (distance * distance) * t * t * (3.0f - 2.0f * t);
    CHECK(image.at(x, 16, 0) == Approx(expected).epsilon(2e-3).margin(2e-4));
  }
}

TEST_CASE("a spot light wider than a half space still casts shadows") {
  SceneBuilder builder = floorFromAbove(1.0f, 16);
  Light& spot = builder.light(LightKind::spot, {5, 5, 5}, {0, 1, 0}, {0, -1, 0});
  spot.innerAngle = glm::radians(85.0f);
  spot.outerAngle = glm::radians(89.0f);
  builder.quad({-0.1f, 0.5f, -0.1f}, {0, 0, 0.2f}, {0.2f, 0, 0}, builder.lambert(0.0f));
  const ImageBuffer image = direct(builder.scene);
  CHECK(image.at(7, 9, 0) == 0.0f);  // the blocker itself is black, its shadow too
  CHECK(image.at(1, 1, 0) > 0.1f);
}

TEST_CASE("point samples of a quad light reach Lambert's polygon irradiance within 2 % at 256 samples") {
  SceneBuilder builder = floorFromAbove(1.0f, 16);
  // Facing down: cross(x, z) = -y.
  builder.quad({-0.25f, 1.0f, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}, builder.lambert(0.0f, 2.0f));
  builder.look({0, 0.5, 0}, {0, 0, 0}, {0, 0, -1}, 2.0 * std::atan(1.0 / 0.5), 16,
               16);  // from below the area light
  RenderOptions options;
  options.parameters = pipeline("direct_lighting").settings({"area_samples=256"});
  const ImageBuffer image = direct(builder.scene, options);
  const std::vector<glm::dvec3> areaLight{
      {-0.25, 1, -0.25}, {0.25, 1, -0.25}, {0.25, 1, 0.25}, {-0.25, 1, 0.25}};
  for (const glm::ivec2 pixel : {glm::ivec2(8, 8), glm::ivec2(2, 3), glm::ivec2(13, 8)}) {
    const double expected = 2.0 * polygonFormFactor(floorPoint(pixel.x, pixel.y, 16), {0, 1, 0}, areaLight);
    CHECK_THAT(image.at(pixel.x, pixel.y, 0), WithinRel(static_cast<float>(expected), 0.02f));
  }
}

TEST_CASE("an emissive triangle is bright from its front and dark from its back") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.0f, 3.0f));  // front side up
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.5, 8, 8);
  CHECK(direct(builder.scene).at(4, 4, 0) == Approx(3.0f));
  builder.look({0, -3, 0}, {0, 0, 0}, {0, 0, -1}, 0.5, 8, 8);
  CHECK(direct(builder.scene).at(4, 4, 0) == 0.0f);
}

TEST_CASE("an area light that its placement mirrors shines from the same side of its surface") {
  // Turned over by the mirror at y = 1/2, the lamp above the floor faces down: seen from below it is bright.
  SceneBuilder builder = floorFromAbove(0.5f, 8);
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.0f, 3.0f));  // faces up
  place(builder.scene, builder.scene.objects.back(), {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1});
  builder.look({0, 0.5, 0}, {0, 0, 0}, {0, 0, -1}, 0.5, 8, 8);
  CHECK(direct(builder.scene).at(4, 4, 0) > 0.1f);
  builder.look({0, 0.5, 0}, {0, 1, 0}, {0, 0, -1}, 0.5, 8, 8);
  CHECK(direct(builder.scene).at(4, 4, 0) == Approx(3.0f));
  builder.look({0, 3, 0}, {0, 1, 0}, {0, 0, -1}, 0.5, 8, 8);
  CHECK(direct(builder.scene).at(4, 4, 0) == 0.0f);
}

TEST_CASE("row 0 is the top of the image and column 0 its left") {
  SceneBuilder builder;
  // Seen along -z with y up: a bright emitter in the upper left quarter.
  builder.quad({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, builder.lambert(0.0f, 1.0f));
  builder.look({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(1.0 / 3.0), 8, 8);
  const ImageBuffer image = direct(builder.scene);
  CHECK(image.at(1, 1, 0) == Approx(1.0f));
  CHECK(image.at(6, 1, 0) == 0.0f);
  CHECK(image.at(1, 6, 0) == 0.0f);
}

TEST_CASE("a surface in the shadow of a blocker receives nothing and its surroundings do") {
  SceneBuilder builder = floorFromAbove(1.0f, 64);
  builder.light(LightKind::directional, {1, 1, 1}, {}, {1, -1, 0});
  // At height 0.5 the shadow of x in [-0.75,-0.25] falls on x in [-0.25,0.25].
  builder.quad({-0.75f, 0.5f, -0.25f}, {0, 0, 0.5f}, {0.5f, 0, 0}, builder.lambert(0.5f));
  const ImageBuffer image = direct(builder.scene);
  CHECK(image.at(35, 32, 0) == 0.0f);
  CHECK(image.at(50, 32, 0) > 0.1f);
  CHECK(image.at(35, 8, 0) > 0.1f);
}

TEST_CASE("a scene without lights or emission is black, and its shadow pass is left out") {
  SceneBuilder builder = floorFromAbove(0.5f, 8);
  const FrameResult frame = renderOnce(builder.scene, pipeline("direct_lighting"));
  for (const float value : frame.outputs.at("direct").values()) CHECK(value == 0.0f);
  for (const PassRecord& pass : frame.passes) CHECK(pass.name != "shadow");
}

TEST_CASE("what camera rays meet when they miss everything is the environment") {
  SceneBuilder builder;
  builder.scene.environment = {0.25f, 0.5f, 1.0f};
  const ImageBuffer image = direct(builder.scene);
  CHECK(image.at(0, 0, 0) == 0.25f);
  CHECK(image.at(7, 3, 2) == 1.0f);
}

TEST_CASE("a scene moved a million metres with its camera gives the same image") {
  const auto render = [](double shift) {
    SceneBuilder builder = floorFromAbove(0.5f, 32);
    builder.light(LightKind::point, {3, 3, 3}, glm::dvec3(0.2 + shift, 1.0, 0.0));
    for (Object& object : builder.scene.objects) object.placement[3][0] += shift;
    Camera& camera = builder.scene.cameras.front();
    camera.eye.x += shift;
    camera.target.x += shift;
    return direct(builder.scene);
  };
  const ImageBuffer here = render(0.0), there = render(1e6);
  for (std::size_t i = 0; i < here.values().size(); ++i)
    CHECK(there.values()[i] == Approx(here.values()[i]).epsilon(1e-3));
}
