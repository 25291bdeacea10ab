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
  return gbufferWhere({kPixels, kPixels}, [](int x, int y) {
    const int pixel = y * kPixels + x;
    return SeenSurface{
        .position = floorPlace(pixel), .diffuse = glm::vec3(0.5f), .specular = {}, .hit = pixel != 0};
  });
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
  result.lights = bufferOf<LightSampleData>({light});
  result.views = bufferOf<glm::mat4>({view});
  result.depth = filled({gpu::TextureKind::d2Array, gpu::Format::depth32f, 4, 4, 1, 1}, glm::vec4(0.0f));
  return result;
}

}  // namespace

TEST_CASE(
    "what lies outside of a shadow view on any side is lit, and a pixel without a surface shows what is around") {
  Scene scene = emptyScene();
  scene.environment = {1.0f, 2.0f, 3.0f};
  const ImageBuffer image = LonePass("direct_lighting.shade", scene)
                                .in("gbuffer", floorSeen())
                                .in("shadow", darkSquare())
                                .image("radiance", 4);
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
  LonePass shade("direct_lighting.shade", scene);
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
  lights.lights = bufferOf<LightSampleData>({sun, patch});
  shade.in("gbuffer", floorSeen()).in("shadow", lights);
  const auto radianceAt = [&](int pixel, const char* areaLights) {
    return valueOf(shade.with({{"area_lights", areaLights}}).image("radiance", 4), pixel);
  };
  const int middle = kPixels / 2 * kPixels + kPixels / 2;
  CHECK(radianceAt(middle, "off") == Approx(0.5).epsilon(1e-4));
  // Albedo over pi times the intensity, at a distance of a metre.
  CHECK(radianceAt(middle, "on") == Approx(0.5 + 0.5 / kPi).epsilon(2e-3));
}
