// Dependence of the light of surfaces on more than the diffuse albedo: the Phong lobe, and the holes of alpha
// masks.
#include <glm/gtc/constants.hpp>

#include "support/filtered.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::WithinRel;

namespace {

constexpr int kSide = 16;

/// A floor of 2 m x 2 m at y = 0 facing up, seen from 3 m above; `up` of the image is -z.
SceneBuilder floorOf(const Material& material) {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.material(material));
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 2.0 * std::atan(1.0 / 3.0), kSide, kSide);
  return builder;
}

glm::dvec3 floorPoint(int x, int y) {
  return {2.0 * (x + 0.5) / kSide - 1.0, 0.0, 2.0 * (y + 0.5) / kSide - 1.0};
}

/// The left half of the mask (u < 0.5) is a hole.
SurfaceTexture holeOnTheLeft() {
  SurfaceTexture half;
  half.width = 2;
  half.height = 1;
  half.mask = true;
  half.values = {0.0f, 1.0f};
  return half;
}

ImageBuffer directLight(const Scene& scene) {
  return renderOnce(scene, pipeline("direct_lighting")).outputs.at("direct");
}

}  // namespace

TEST_CASE(
    "a Phong floor under a directional light shows (n + 2) / (2 pi) cos^n around the mirror direction") {
  const glm::dvec3 travel = glm::normalize(glm::dvec3(0.2, -1.0, 0.1));
  const double irradiance = 3.0 * -travel.y;
  for (const float exponent : {1.0f, 4.0f, 50.0f}) {
    CAPTURE(exponent);
    Material shiny;
    shiny.specular = {0.5f, 0.25f, 0.125f};
    shiny.exponent = exponent;
    SceneBuilder builder = floorOf(shiny);
    builder.light(LightKind::directional, {3, 3, 3}, {}, travel);
    const ImageBuffer image = directLight(builder.scene);
    const glm::dvec3 mirrored(travel.x, -travel.y, travel.z);
    for (const glm::ivec2 pixel :
         {glm::ivec2(2, 13), glm::ivec2(8, 8), glm::ivec2(9, 7), glm::ivec2(14, 3)}) {
      const glm::dvec3 toEye = glm::normalize(glm::dvec3(0, 3, 0) - floorPoint(pixel.x, pixel.y));
      const double cosine = std::max(0.0, glm::dot(mirrored, toEye));
      const double lobe = (exponent + 2.0) / (2.0 * glm::pi<double>()) * std::pow(cosine, double(exponent));
      for (int c = 0; c < 3; ++c)
        CHECK_THAT(image.at(pixel.x, pixel.y, c),
                   WithinRel(static_cast<float>(shiny.specular[c] * lobe * irradiance), 2e-3f));
    }
  }
}

TEST_CASE("a light more than a right angle off the mirror direction adds nothing to a Phong surface") {
  // Seen and lit at a slant from the same side: the mirror direction points away from the light, 2 x 50
  // degrees.
  for (const float exponent : {0.0f, 1.0f, 8.0f}) {
    Material shiny;
    shiny.specular = glm::vec3(0.5f);
    shiny.exponent = exponent;
    SceneBuilder builder = floorOf(shiny);
    const double slant = glm::radians(50.0);
    const glm::dvec3 towards(std::sin(slant), std::cos(slant), 0.0);
    builder.look(4.0 * towards, {0, 0, 0}, {0, 1, 0}, 0.1, kSide, kSide);
    builder.light(LightKind::directional, {3, 3, 3}, {}, -towards);
    const ImageBuffer image = directLight(builder.scene);
    for (const float radiance : image.values()) CHECK(radiance == 0.0f);
  }
}

TEST_CASE("a Phong lobe of exponent 0 or 0.1 reaches up to a right angle off the mirror direction") {
  // Seen at a slant of 40 degrees from the side of the light, which is a + b off the mirror direction.
  constexpr double kSeen = 40.0;
  for (const float exponent : {0.0f, 0.1f})
    for (const double slant : {5.0, 36.0, 49.0}) {
      CAPTURE(exponent, slant);
      Material shiny;
      shiny.specular = glm::vec3(0.5f);
      shiny.exponent = exponent;
      SceneBuilder builder = floorOf(shiny);
      const auto towards = [](double degrees) {
        return glm::dvec3(std::sin(glm::radians(degrees)), std::cos(glm::radians(degrees)), 0.0);
      };
      builder.look(4.0 * towards(kSeen), {0, 0, 0}, {0, 1, 0}, 1e-3, kSide, kSide);
      builder.light(LightKind::directional, {3, 3, 3}, {}, -towards(slant));
      const double lobe = (exponent + 2.0) / (2.0 * glm::pi<double>()) *
                          std::pow(std::cos(glm::radians(kSeen + slant)), double(exponent));
      const double expected = 0.5 * lobe * 3.0 * std::cos(glm::radians(slant));
      CHECK_THAT(directLight(builder.scene).at(8, 8, 1), WithinRel(static_cast<float>(expected), 5e-3f));
    }
}

TEST_CASE("a blocker casts the shadow of what its alpha mask keeps, and the hole lets the light through") {
  Material white;
  white.diffuse = glm::vec3(0.5f);
  SceneBuilder builder = floorOf(white);
  Material masked;
  masked.maskTexture = static_cast<int>(builder.scene.textures.size());
  builder.scene.textures.push_back(holeOnTheLeft());
  // Wider than the floor and above the camera, so that it is not seen.
  builder.quad({-2, 4, -2}, {4, 0, 0}, {0, 0, 4}, builder.material(masked));
  builder.light(LightKind::directional, {3, 3, 3}, {}, {0, -1, 0});
  const ImageBuffer image = directLight(builder.scene);
  const float lit = 0.5f / glm::pi<float>() * 3.0f;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      // Bilinear filtering of the mask has its threshold in the middle; the shadow map's texels blur a pixel
      // there.
      if (x == kSide / 2 - 1 || x == kSide / 2) continue;
      CAPTURE(x, y);
      if (x < kSide / 2)
        CHECK_THAT(image.at(x, y, 0), WithinRel(lit, 1e-3f));
      else
        CHECK(image.at(x, y, 0) == 0.0f);
    }
  }
}

TEST_CASE("the camera looks through the holes of alpha masks") {
  Material white;
  white.diffuse = glm::vec3(0.5f);
  SceneBuilder builder = floorOf(white);
  Material masked;
  masked.diffuse = glm::vec3(1.0f);
  masked.maskTexture = static_cast<int>(builder.scene.textures.size());
  builder.scene.textures.push_back(holeOnTheLeft());
  // Just above the floor, facing up, u along x.
  builder.quad({-1, 0.01f, 1}, {2, 0, 0}, {0, 0, -2}, builder.material(masked));
  builder.light(LightKind::directional, {3, 3, 3}, {}, glm::normalize(glm::dvec3(0.001, -1, 0)));
  const ImageBuffer image = directLight(builder.scene);
  for (int y = 1; y < kSide - 1; ++y) {
    CHECK_THAT(image.at(2, y, 0), WithinRel(0.5f / glm::pi<float>() * 3.0f, 2e-3f));
    CHECK_THAT(image.at(kSide - 3, y, 0), WithinRel(1.0f / glm::pi<float>() * 3.0f, 2e-3f));
  }
}

TEST_CASE(
    "an image whose plane is shifted by parts of a pixel is made of pixels of an image with more of them") {
  // A wide angle: a camera that turned in place of it would shift the corners twice as far.
  constexpr int kFiner = 4;
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.7f), true);
  builder.light(LightKind::point, {5, 5, 5}, {0.3, 0.2, -0.1});
  builder.look({0.1, 0.2, 0.9}, {-0.2, 0.1, -1}, {0, 1, 0}, glm::half_pi<double>(), kSide, kSide / 2);
  const Pipeline direct = pipeline("direct_lighting");
  const auto rendered = [&](int pixelsPerPixel, const glm::vec2& shift) {
    RenderOptions options;
    options.width = pixelsPerPixel * kSide;
    options.height = pixelsPerPixel * kSide / 2;
    PipelineExecutor executor(device(), techniques(), builder.scene, direct, options);
    SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0, {}, options.width, options.height);
    snapshot.camera.shift = shift;
    return executor.render(snapshot, 0).outputs.at("direct");
  };
  const ImageBuffer finer = rendered(kFiner, glm::vec2(0.0f));
  for (const glm::ivec2 part : {glm::ivec2(0, 0), glm::ivec2(3, 1), glm::ivec2(1, 2)}) {
    CAPTURE(part.x, part.y);
    const ImageBuffer shifted = rendered(1, (glm::vec2(part) + 0.5f) / static_cast<float>(kFiner) - 0.5f);
    for (int y = 0; y < kSide / 2; ++y)
      for (int x = 0; x < kSide; ++x)
        for (int c = 0; c < 3; ++c)
          CHECK_THAT(shifted.at(x, y, c),
                     WithinRel(finer.at(kFiner * x + part.x, kFiner * y + part.y, c), filtered(1e-3f)));
  }
}

TEST_CASE("a g-buffer tells of each pixel what moves together, 0 where it stands still") {
  SceneBuilder builder = floorOf({});
  const int white = builder.lambert(0.5f);
  for (int i = 0; i < 3; ++i) {
    Object& tile =
        builder.quad({-0.8f + 0.6f * static_cast<float>(i), 0.1f, -0.2f}, {0, 0, 0.4f}, {0.4f, 0, 0}, white);
    tile.motion = RigidMotion{};
    tile.motion->angularSpeed = i == 1 ? 2.0 : 1.0;  // the first and the last turn together
  }
  const std::vector<float> normals = gbufferOf(builder.scene).geometricNormal->downloadFloats(0);
  const auto modelAt = [&](double x, double z) {
    const auto pixel = [](double at) { return static_cast<std::size_t>((0.5 + 0.5 * at) * kSide); };
    return normals[4 * (pixel(z) * kSide + pixel(x)) + 3];
  };
  CHECK(modelAt(-0.6, 0.0) == 1.0f);
  CHECK(modelAt(0.0, 0.0) == 2.0f);
  CHECK(modelAt(0.6, 0.0) == 1.0f);
  CHECK(modelAt(0.0, 0.6) == 0.0f);
}
