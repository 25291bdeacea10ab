// Shading of surfaces and shadow maps that are made here.
#include "lumivox/toolkit/light_samples.h"
#include "support/marching.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Pixels look down at a floor of 2 m x 2 m, of albedo 1/2; the first of them sees nothing.
glm::vec3 floorPlace(int pixel) {
  return {2.0f * (static_cast<float>(pixel % kPixels) + 0.5f) / kPixels - 1.0f, 0.0f,
          2.0f * (static_cast<float>(pixel / kPixels) + 0.5f) / kPixels - 1.0f};
}

GBuffer floorSeen() {
  GBuffer result;
  std::vector<glm::vec4> places, normals, albedos;
  for (int i = 0; i < kPixels * kPixels; ++i) {
    places.emplace_back(floorPlace(i), i == 0 ? 0.0f : 1.0f);
    normals.emplace_back(0.0f, 1.0f, 0.0f, 1.0f);
    albedos.emplace_back(0.5f);
  }
  result.position = image(places);
  result.normal = result.geometricNormal = image(normals);
  result.diffuse = image(albedos);
  return result;
}

/// Light from above, pi W/m^2, whose one shadow view holds |x| < 0.5, |z| < 0.5 and is shadowed everywhere.
ShadowMap darkSquare() {
  LightSampleData light{};
  light.direction = {0, -1, 0};
  light.power = glm::vec3(static_cast<float>(kPi));
  light.viewCount = 1;
  light.texelWidth = 0.25f;  // m, width of a texel
  glm::mat4 view(0.0f);
  view[0][0] = view[2][1] = 2.0f;
  view[3] = {0, 0, 0.5f, 1};
  ShadowMap result;
  result.lightCount = result.layerCount = 1;
  result.lights = std::make_shared<gpu::Buffer>(device(), sizeof(light), "light");
  result.lights->uploadValues(std::span<const LightSampleData>(&light, 1));
  result.views = std::make_shared<gpu::Buffer>(device(), sizeof(view), "view");
  result.views->uploadValues(std::span<const glm::mat4>(&view, 1));
  result.depth = std::make_shared<gpu::Texture>(
      device(), gpu::TextureDescription{gpu::TextureKind::d2Array, gpu::Format::depth32f, 4, 4, 1, 1},
      "depth");
  result.depth->clear(glm::vec4(0.0f));
  return result;
}

}  // namespace

TEST_CASE(
    "what lies outside of a shadow view on any side is lit, and a pixel without a surface shows what is around") {
  Scene scene = emptyScene();
  scene.environment = {1.0f, 2.0f, 3.0f};
  PassHarness shade(device(), techniques(), "direct_lighting", "shade", scene, snapshotOf(scene, 0.0));
  shade.setInput("gbuffer", floorSeen());
  shade.setInput("shadow", darkSquare());
  shade.run();
  const ImageBuffer image = imageOf(*shade.output<Image>("radiance").texture, 4);
  for (int i = 1; i < kPixels * kPixels; ++i) {
    const glm::vec3 place = floorPlace(i);
    const bool dark = std::abs(place.x) < 0.5f && std::abs(place.z) < 0.5f;
    CAPTURE(place.x, place.z);
    CHECK(valueOf(image, i) == Approx(dark ? 0.0 : 0.5).epsilon(1e-4));
  }
  for (int c = 0; c < 3; ++c) CHECK(valueOf(image, 0, c) == scene.environment[c]);
  for (const int pixel : {0, 1}) CHECK(valueOf(image, pixel, 3) == 1.0f);
}

TEST_CASE(
    "shading that leaves out emissive surfaces as lights keeps all other lights, and what shines is still seen") {
  Scene scene = emptyScene();
  scene.lights.emplace_back();  // the sun below: lights without extent come first
  PassHarness shade(device(), techniques(), "direct_lighting", "shade", scene, snapshotOf(scene, 0.0));
  shade.setInput("gbuffer", floorSeen());
  ShadowMap lights = darkSquare();
  LightSampleData sun{};
  sun.direction = {0, -1, 0};
  sun.power = glm::vec3(static_cast<float>(kPi));
  sun.firstView = -1;
  LightSampleData patch{};  // 1 W/sr from a metre above the middle, downwards
  patch.kind = LightSampleKind::area;
  patch.position = {0, 1, 0};
  patch.direction = {0, -1, 0};
  patch.power = glm::vec3(1.0f);
  patch.firstView = -1;
  lights.lightCount = 2;
  lights.lights = std::make_shared<gpu::Buffer>(device(), 2 * sizeof(sun), "lights");
  lights.lights->uploadValues(std::span<const LightSampleData>(std::array{sun, patch}));
  shade.setInput("shadow", lights);
  const auto radianceAt = [&](int pixel, const char* areaLights) {
    shade.setParameter("area_lights", std::string(areaLights));
    shade.run();
    return valueOf(imageOf(*shade.output<Image>("radiance").texture, 4), pixel);
  };
  const int middle = kPixels / 2 * kPixels + kPixels / 2;
  CHECK(radianceAt(middle, "off") == Approx(0.5).epsilon(1e-4));
  // Albedo over pi times the intensity, at a distance of a metre.
  CHECK(radianceAt(middle, "on") == Approx(0.5 + 0.5 / kPi).epsilon(2e-3));
}
