// The path tracer's media against closed forms: Beer-Lambert, single scattering, furnaces.
#include <cmath>

#include "lumivox/reference/path_tracer.h"
#include "reference/media.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Medium evenMedium(const glm::vec3& extinction, const glm::vec3& albedo, float anisotropy,
                  const glm::dvec3& low, const glm::dvec3& high) {
  Medium medium;
  medium.name = "even";
  medium.extinction = extinction;
  medium.albedo = albedo;
  medium.anisotropy = anisotropy;
  medium.box.emplace(low, high);
  return medium;
}

/// The same density everywhere inside a cube of 16 voxels; outside it falls to 0 over half a voxel.
Medium volumeMedium(const glm::vec3& extinction, const glm::vec3& albedo, const glm::dvec3& low,
                    double extent, float density) {
  auto volume = std::make_shared<DensityVolume>();
  volume->resolution = glm::ivec3(16);
  volume->low = low;
  volume->voxelSize = extent / 16.0;
  volume->values.assign(16 * 16 * 16, density);
  Medium medium;
  medium.name = "volume";
  medium.extinction = extinction;
  medium.albedo = albedo;
  medium.volume = volume;
  return medium;
}

/// A wall of radiance 1 that fills the image, two metres in front of the camera.
SceneBuilder shiningWall(int size) {
  SceneBuilder builder;
  builder.quad({-5, -5, -2}, {10, 0, 0}, {0, 10, 0}, builder.lambert(0.0f, 1.0f));
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.01, size, size);
  return builder;
}

double henyeyGreenstein(double g, double cosine) {
  return (1.0 - g * g) / (4.0 * kPi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

/// Simpson's rule.
template <class Function>
double integral(double low, double high, int halves, Function&& f) {
  const double h = (high - low) / (2.0 * halves);
  double sum = f(low) + f(high);
  for (int i = 1; i < 2 * halves; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * f(low + i * h);
  return sum * h / 3.0;
}

Scene furnaceWith(const Medium& medium, int size) {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1.5f, 2}, builder.lambert(0.5f, 1.0f), true);
  builder.look({0.5, 0.7, 1.6}, {0.3, 0.4, 0}, {0, 1, 0}, 1.2, size, size);
  builder.scene.media.push_back(medium);
  return builder.scene;
}

}  // namespace

TEST_CASE("the phase function integrates to 1 and its mean cosine is g, as are those of sampled directions") {
  for (const float g : {-0.99f, -0.5f, 0.0f, 0.0005f, 0.3f, 0.99f}) {
    CAPTURE(g);
    // mu = +-(1 - 2 t^3) puts the nodes into the narrow lobe; dmu = 6 t^2 dt.
    const double side = g < 0.0f ? -1.0 : 1.0;
    double whole = 0.0, mean = 0.0;
    constexpr int kNodes = 20000;
    for (int i = 0; i < kNodes; ++i) {
      const double t = (i + 0.5) / kNodes, mu = side * (1.0 - 2.0 * t * t * t);
      const double share = 2.0 * kPi * reference::phase(g, static_cast<float>(mu)) * 6.0 * t * t / kNodes;
      whole += share;
      mean += share * mu;
    }
    CHECK(whole == Approx(1.0).epsilon(1e-3));  // 1 - mu in single precision, where the lobe is 5e-5 wide
    CHECK(mean == Approx(g).margin(1e-3));
    double sampled = 0.0;
    for (int i = 0; i < kNodes; ++i)
      sampled += reference::samplePhaseCosine(g, (static_cast<float>(i) + 0.5f) / kNodes) / kNodes;
    CHECK(sampled == Approx(g).margin(1e-4));
  }
}

TEST_CASE("an even medium lets exp(-sigma_t d) through, in each channel, within 0.1 %") {
  SceneBuilder builder = shiningWall(4);
  const glm::vec3 extinction(0.3f, 1.0f, 4.0f);
  builder.scene.media.push_back(evenMedium(extinction, glm::vec3(0.0f), 0, {-1, -1, -1.5}, {1, 1, -0.5}));
  const LayeredImage image = renderReference(builder.scene, quietly(8));
  for (int channel = 0; channel < 3; ++channel) {
    const double expected = std::exp(-extinction[channel]);  // 1 m of it; the camera looks straight
    CHECK(image.layers.at("transmittance").at(2, 2, channel) == Approx(expected).epsilon(0.001));
    CHECK(image.layers.at("full").at(2, 2, channel) == Approx(expected).epsilon(0.001));
    CHECK(image.layers.at("direct").at(2, 2, channel) == 1.0f);  // as it leaves the surface
  }
}

TEST_CASE("a medium on a grid lets exp(-sigma_t d) through: ratio tracking has no bias") {
  // Density 0.7 over 1 m, and what trilinear interpolation adds beyond the outer centres: density falls from
  // 0.7 to 0 between half a voxel inside and half a voxel outside of each face, the same integral as a sharp
  // edge.
  SceneBuilder builder = shiningWall(64);
  builder.scene.media.push_back(
      volumeMedium(glm::vec3(0.5f, 1.0f, 3.0f), glm::vec3(0.0f), {-0.5, -0.5, -1.5}, 1.0, 0.7f));
  const LayeredImage image = renderReference(builder.scene, quietly(128));
  const ImageBuffer& transmittance = image.layers.at("transmittance");
  for (int channel = 0; channel < 3; ++channel) {
    const double expected = std::exp(-0.7 * (channel == 0 ? 0.5 : channel == 1 ? 1.0 : 3.0));
    double mean = 0.0, variance = 0.0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        mean += transmittance.at(x, y, channel) / 4096.0;
        variance += image.layers.at("transmittance.variance").at(x, y, channel) / 4096.0 / 4096.0;
      }
    CAPTURE(channel, expected, mean, std::sqrt(variance));
    CHECK(std::abs(mean - expected) < 4.0 * std::sqrt(variance) + 1e-6);
    CHECK(mean == Approx(expected).epsilon(0.005));
  }
}

TEST_CASE("single scattering of a point light along a ray is its integral within 1 %, in each channel") {
  // L = int sigma_s p(cos) I / r^2 exp(-sigma_t (t + r)) dt over the ray from -2 to 2 m, the light at height
  // h.
  for (const float g : {0.0f, 0.7f, -0.4f}) {
    SceneBuilder builder;
    const glm::vec3 extinction(0.2f, 0.5f, 1.1f), albedo(0.9f, 0.5f, 1.0f);
    builder.scene.media.push_back(evenMedium(extinction, albedo, g, glm::dvec3(-2), glm::dvec3(2)));
    builder.light(LightKind::point, glm::vec3(10.0f), {0.3, 0.6, 0});
    const glm::vec3 measured =
        referenceRadiance(builder.scene, 0.0, {-2, 0, 0}, {1, 0, 0}, quietly(400000, 0));
    for (int channel = 0; channel < 3; ++channel) {
      const double expected = integral(-2.0, 2.0, 2000, [&](double x) {
        const double dx = 0.3 - x, r = std::hypot(dx, 0.6);
        return double(extinction[channel]) * albedo[channel] * henyeyGreenstein(g, dx / r) * 10.0 / (r * r) *
               std::exp(-double(extinction[channel]) * (x + 2.0 + r));
      });
      CAPTURE(g, channel, expected);
      CHECK(measured[channel] == Approx(expected).epsilon(0.01));
    }
  }
}

TEST_CASE("a medium that absorbs nothing leaves a closed furnace as it is") {
  // Emission 1 and albedo 1/2: radiance 2 everywhere, with any medium of albedo 1 in the room.
  Medium cloud;
  cloud.extinction = glm::vec3(3.0f);
  cloud.albedo = glm::vec3(1.0f);
  cloud.anisotropy = -0.5f;
  cloud.particles = 300;
  cloud.source = {0.5, 0.3, 1.0};
  cloud.spread = cloud.radius = 0.2;
  cloud.rise = 0.2;
  const Medium media[] = {evenMedium({1.0f, 2.0f, 4.0f}, glm::vec3(1.0f), 0.6f, {0, 0, 0}, {1, 1.5, 2}),
                          volumeMedium({4.0f, 2.0f, 1.0f}, glm::vec3(1.0f), {0.1, 0.1, 0.2}, 0.8, 2.0f),
                          cloud};
  for (const Medium& medium : media) {
    const LayeredImage image = renderReference(furnaceWith(medium, 16), quietly(128, 1000));
    const Estimate full = estimateOf(image, "full");
    CAPTURE(medium.name, full.deviation);
    CHECK(full.deviation < 0.02);
    CHECK(std::abs(full.mean - 2.0) < 4.0 * full.deviation);
    CHECK(estimateOf(image, "scattered").mean > 0.05);
  }
}

TEST_CASE("two media in one place are the medium with the sum of their coefficients") {
  SceneBuilder together, apart;
  const glm::dvec3 low(-1), high(1);
  together.scene.media = {evenMedium(glm::vec3(1.5f), glm::vec3(0.6f), 0.3f, low, high)};
  apart.scene.media = {evenMedium(glm::vec3(1.0f), glm::vec3(0.9f), 0.3f, low, high),
                       evenMedium(glm::vec3(0.5f), glm::vec3(0.0f), 0.3f, low, high)};
  for (SceneBuilder* builder : {&together, &apart}) {
    builder->light(LightKind::directional, glm::vec3(3.0f), {}, {0.3, -1, 0.2});
    builder->look({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.4, 24, 24);
  }
  const LayeredImage a = renderReference(together.scene, quietly(512)),
                     b = renderReference(apart.scene, quietly(512));
  for (const char* layer : {"transmittance", "scattered_single", "scattered_multiple", "full"}) {
    const Estimate one = estimateOf(a, layer), two = estimateOf(b, layer);
    CAPTURE(layer, one.mean, two.mean);
    CHECK(std::abs(one.mean - two.mean) < 4.0 * std::hypot(one.deviation, two.deviation) + 1e-6);
    CHECK(one.mean > 0.0);
  }
}

TEST_CASE("the layers of a scene with media add up, whatever the number of threads") {
  Scene scene = litRoom(24, 24);
  scene.media.push_back(evenMedium(glm::vec3(0.8f), glm::vec3(0.9f), 0.5f, {0, 0, 0}, {1, 1, 1}));
  scene.media.push_back(volumeMedium({4, 5, 6}, {0.9f, 0.8f, 0.7f}, {0.2, 0.2, 0.2}, 0.5, 1.0f));
  ReferenceOptions options = quietly(16);
  options.threads = 1;
  const LayeredImage one = renderReference(scene, options);
  options.threads = 3;
  const LayeredImage three = renderReference(scene, options);
  CHECK(one.layers.size() == 24);
  for (const auto& [name, layer] : one.layers) CHECK(layer.values() == three.layers.at(name).values());
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x)
      CHECK(one.layers.at("scattered").at(x, y, 0) == Approx(one.layers.at("scattered_single").at(x, y, 0) +
                                                             one.layers.at("scattered_multiple").at(x, y, 0))
                                                          .epsilon(1e-5)
                                                          .margin(1e-6));
}

TEST_CASE("emissive triangles and light samples agree in a medium: an area light's scattering has no seam") {
  // An area light so near that phase-sampled rays often meet it, and its equivalent seen by next-event
  // estimation alone is the integral over its face: single scattering at a point times the path, in an
  // optically thin medium.
  SceneBuilder builder;
  builder.quad({-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, builder.lambert(0.0f, 2.0f));  // shines downwards
  builder.scene.media.push_back(
      evenMedium(glm::vec3(0.01f), glm::vec3(1.0f), 0.8f, {-1, -0.05, -0.05}, {1, 0.05, 0.05}));
  const glm::vec3 measured = referenceRadiance(builder.scene, 0.0, {-1, 0, 0}, {1, 0, 0}, quietly(400000, 0));
  const double expected = integral(-1.0, 1.0, 40, [&](double x) {
    return 0.01 * integral(-0.5, 0.5, 40, [&](double u) {
             return integral(-0.5, 0.5, 40, [&](double v) {
               const double dx = u - x, r = std::sqrt(dx * dx + 1.0 + v * v);
               return henyeyGreenstein(0.8, dx / r) * 2.0 * (1.0 / r) / (r * r);
             });
           });
  });
  CHECK(measured.x == Approx(expected).epsilon(0.02));
}
