#include <cmath>
#include <cstring>

#include "lumivox/base/file.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/pipeline/gpu_scene.h"
#include "lumivox/reference/path_tracer.h"
#include "lumivox/scene/medium.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kPixels = 64;

gpu::TextureRef image(const std::vector<glm::vec4>& values) {
  gpu::TextureDescription description;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = kPixels;
  auto texture = std::make_shared<gpu::Texture>(device(), description, "test image");
  std::vector<float> floats;
  for (const glm::vec4& value : values) floats.insert(floats.end(), {value.x, value.y, value.z, value.w});
  texture->uploadFloats(0, floats);
  return texture;
}

/// A g-buffer in which pixel i sees a surface at place(i), in metres.
GBuffer surfacesAt(const std::function<glm::vec3(int)>& place) {
  std::vector<glm::vec4> positions;
  for (int i = 0; i < kPixels * kPixels; ++i) positions.emplace_back(place(i), 1.0f);
  GBuffer result;
  result.position = image(positions);
  return result;
}

Scene emptyScene() {
  SceneBuilder builder;
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7, kPixels, kPixels);
  return builder.scene;
}

ScatteringGrid evenMedium(const glm::vec3& extinction, const glm::vec3& albedo, float anisotropy,
                          const glm::vec3& low, const glm::vec3& high) {
  ScatteringGrid::Medium medium;
  medium.name = "even";
  medium.bounds.grow(low);
  medium.bounds.grow(high);
  medium.extinction = extinction;
  medium.albedo = albedo;
  medium.anisotropy = anisotropy;
  return {{medium}};
}

/// Densities at the centres of voxels.
ScatteringGrid varyingMedium(float extinction, float albedo, float anisotropy, const glm::vec3& low,
                             float voxelSize, const glm::ivec3& size,
                             const std::function<float(const glm::vec3&)>& densityAt) {
  ScatteringGrid result = evenMedium(glm::vec3(extinction), glm::vec3(albedo), anisotropy,
                                     low - 0.5f * voxelSize, low + voxelSize * (glm::vec3(size) + 0.5f));
  ScatteringGrid::Medium& medium = result.media.front();
  medium.grid = {low, voxelSize, size};
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d3;
  description.format = gpu::Format::r32f;
  description.width = size.x;
  description.height = size.y;
  description.depth = size.z;
  medium.density = std::make_shared<gpu::Texture>(device(), description, "test density");
  std::vector<float> values;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        values.push_back(densityAt(low + voxelSize * (glm::vec3(x, y, z) + 0.5f)));
  medium.density->uploadFloats(0, values);
  return result;
}

struct Marched {
  Picture scattered, transmittance;
};
using Settings = std::vector<std::pair<std::string, std::string>>;

/// Full resolution, steps looked at in their middle.
Marched march(const Scene& scene, const ScatteringGrid& media, const GBuffer& gbuffer, int steps,
              const Settings& words = {}, const std::vector<std::pair<std::string, int>>& numbers = {}) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness shadow(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
  PassHarness harness(device(), techniques(), "volumetric_smoke", "march", scene, snapshot);
  harness.setParameter("resolution", std::string("full"));
  harness.setParameter("start", std::string("middle"));
  harness.setParameter("steps", steps);
  for (const auto& [name, word] : words) harness.setParameter(name, word);
  for (const auto& [name, number] : numbers) harness.setParameter(name, number);
  harness.setInput("gbuffer", gbuffer);
  harness.setInput("media", media);
  if (!scene.lights.empty()) {
    shadow.run();
    harness.setInput("shadow", shadow.output<ShadowMap>("depth"));
  }
  harness.run();
  return {pictureOf(*harness.output<Image>("scattered").texture),
          pictureOf(*harness.output<Image>("transmittance").texture)};
}

float valueOf(const Picture& picture, int pixel, int channel = 0) {
  return picture.at(pixel % kPixels, pixel / kPixels, channel);
}

double henyeyGreenstein(double g, double cosine) {
  return (1.0 - g * g) / (4.0 * kPi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

Medium smokeMedium() {
  Medium medium;
  medium.name = "smoke";
  medium.extinction = glm::vec3(2.0f);
  medium.albedo = glm::vec3(0.8f);
  medium.particles = 3000;
  medium.source = {0.1, -0.6, 0.2};
  medium.spread = 0.2;
  medium.radius = 0.15;
  medium.rise = 0.4;
  medium.drift = 0.08;
  medium.life = 3.0;
  return medium;
}

Scene smokeScene(const Medium& medium) {
  Scene scene = emptyScene();
  scene.media.push_back(medium);
  return scene;
}

/// The grid after inserting the particles of a scene's media.
ScatteringGrid inserted(const Scene& scene, double time, int resolution,
                        const OccupancyGrid* space = nullptr) {
  const SceneSnapshot snapshot = snapshotOf(scene, time);
  PassHarness particles(device(), techniques(), "volumetric_smoke", "particles", scene, snapshot);
  PassHarness insert(device(), techniques(), "volumetric_smoke", "insert", scene, snapshot);
  particles.run();
  insert.setParameter("resolution", resolution);
  insert.setInput("particles", particles.output<Particles>("particles"));
  if (space != nullptr) insert.setInput("space", *space);
  insert.run();
  return insert.output<ScatteringGrid>("media");
}

double massOf(const ScatteringGrid::Medium& medium) {
  double sum = 0.0;
  for (const float value : medium.density->downloadFloats(0)) sum += value;
  return sum * std::pow(double(medium.grid.voxelSize), 3.0);
}

Scene committed(const char* name) {
  return loadScene(sourceDirectory() / "scenes" / (std::string(name) + ".scene"));
}

RenderOptions sized(int size) {
  RenderOptions options;
  options.width = options.height = size;
  return options;
}

FrameResult frameAt(const Scene& scene, const Pipeline& text, const RenderOptions& options, double time) {
  return PipelineExecutor(device(), techniques(), scene, text, options).render(time);
}

}  // namespace

TEST_CASE("an even medium lets exp(-sigma_t d) through within 0.1 %, whatever the steps") {
  const glm::vec3 extinction(0.5f, 2.0f, 1e4f);
  const ScatteringGrid fog = evenMedium(extinction, glm::vec3(0.5f), 0, {-1, -1, -3}, {1, 1, -1});
  // Pixel i sees a surface i / 4096 * 3 m away, straight ahead: inside the medium from 1 m on.
  const auto distance = [](int i) { return 3.0f * static_cast<float>(i + 1) / (kPixels * kPixels); };
  const GBuffer gbuffer = surfacesAt([&](int i) { return glm::vec3(0, 0, -distance(i)); });
  for (const int steps : {1, 7, 64}) {
    const Marched result = march(emptyScene(), fog, gbuffer, steps);
    for (int i = 0; i < kPixels * kPixels; i += 37) {
      const double inside = std::max(0.0, double(distance(i)) - 1.0);
      for (int channel = 0; channel < 3; ++channel) {
        const double expected = std::exp(-double(extinction[channel]) * inside);
        CHECK(valueOf(result.transmittance, i, channel) == Approx(expected).epsilon(0.001).margin(1e-30));
      }
    }
  }
}

TEST_CASE("one step through extinction 10^4 / m scatters what the closed form says") {
  // Light and view run the same way into the medium, so that both are dimmed alike: L = albedo p(-1) E / 2 in
  // the limit of a thick medium. In the thin limit nothing is dimmed: L = sigma_s p(-1) E d.
  for (const float extinction : {1e4f, 1e-4f}) {
    SceneBuilder builder;
    builder.scene = emptyScene();
    builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0, 0, -1});
    const ScatteringGrid fog =
        evenMedium(glm::vec3(extinction), glm::vec3(0.8f), 0.3f, {-5, -5, -2}, {5, 5, -1});
    const GBuffer gbuffer = surfacesAt([](int) { return glm::vec3(0, 0, -4); });
    const Marched result = march(builder.scene, fog, gbuffer, 1);
    const double phase = henyeyGreenstein(0.3, -1.0);
    const double expected = extinction > 1.0f ? 0.8 * phase * 3.0 / 2.0 : extinction * 0.8 * phase * 3.0;
    CHECK(valueOf(result.scattered, 0) == Approx(expected).epsilon(0.001));
    CHECK(valueOf(result.transmittance, 0) == Approx(extinction > 1.0f ? 0.0 : 1.0 - 1e-4).margin(1e-6));
  }
}

TEST_CASE("voxelised smoke of 10^-3 to 10^5 / m, in 32 steps, scatters what a slab does in closed form") {
  // Plane layers seen from above: at the optical depth t along the view the light has come through t r, r =
  // mu_v / mu_s the ratio of the cosines of view and light with the normal, whatever the density's profile
  // is. So L = albedo p E int_0^T exp(-t (1 + r)) dt = albedo p E (1 - exp(-T (1 + r))) / (1 + r), which is
  // albedo p E mu_s / (mu_s + mu_v) where nothing shines through (the
  // first order of Chandrasekhar 1960, "Radiative transfer").
  ScatteringGrid slab = varyingMedium(
      1.0f, 0.8f, 0.3f, {-6, -6, -1.5f}, 1.0f / 16.0f, {192, 192, 20},
      [](const glm::vec3& place) { return place.z > -0.75f || place.z < -1.25f ? 0.0f : 1.0f; });
  for (const double lightAngle : {0.0, 45.0, 75.0}) {
    SceneBuilder builder;
    builder.scene = emptyScene();
    const double a = lightAngle * kPi / 180.0;
    const glm::dvec3 travel(0.8 * std::sin(a), 0.6 * std::sin(a), -std::cos(a));
    builder.light(LightKind::directional, glm::vec3(2.0f), {}, travel);
    // Pixels look down at 0 to 65 degrees all around, and meet the surface in any part of a step.
    std::vector<glm::dvec3> views;
    for (int i = 0; i < kPixels * kPixels; ++i) {
      const double tilt = 65.0 * kPi / 180.0 * (i / kPixels) / kPixels, turn = 2.4 * i;
      views.emplace_back(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), -std::cos(tilt));
    }
    const GBuffer gbuffer = surfacesAt([&](int i) { return glm::vec3(views[i] * (1.6 / -views[i].z)); });
    for (const char* depth : {"volume", "march"})
      for (const double extinction : {1e-3, 1.0, 10.0, 1e3, 1e5}) {
        slab.media.front().extinction = glm::vec3(static_cast<float>(extinction));
        const Marched result =
            march(builder.scene, slab, gbuffer, 32, {{"light_depth", depth}, {"start", "dithered"}});
        double squares = 0.0, worstTransmittance = 0.0;
        for (int i = 0; i < kPixels * kPixels; ++i) {
          // What trilinear densities add outside of the layer is what they lack inside.
          const double through = extinction * 0.5 / -views[i].z, ratio = views[i].z / travel.z;
          const double wanted = 0.8 * henyeyGreenstein(0.3, -glm::dot(views[i], travel)) * 2.0 /
                                (1.0 + ratio) * -std::expm1(-(1.0 + ratio) * through);
          squares += std::pow(valueOf(result.scattered, i) / wanted - 1.0, 2.0) / (kPixels * kPixels);
          worstTransmittance =
              std::max(worstTransmittance, std::abs(valueOf(result.transmittance, i) - std::exp(-through)));
        }
        CAPTURE(lightAngle, depth, extinction);
        CHECK(std::sqrt(squares) < 0.005);
        CHECK(worstTransmittance < 1e-4);
      }
  }
}

TEST_CASE("an opaque ball of smoke has the light of its surface, mu_s / (mu_s + mu_v)") {
  constexpr double kRadius = 0.6, kAngle = kPi / 6.0;
  SceneBuilder builder;
  builder.scene = emptyScene();
  builder.scene.cameras.front().eye = {0, 0, 4};
  const glm::dvec3 travel(-0.8 * std::sin(kAngle), -0.6 * std::sin(kAngle), -std::cos(kAngle));
  builder.light(LightKind::directional, glm::vec3(1.0f), {}, travel);
  const auto endOf = [](int i) {
    return glm::dvec3(1.6 * (i % kPixels + 0.5) / kPixels - 0.8, 0.8 - 1.6 * (i / kPixels + 0.5) / kPixels,
                      -4.0);
  };
  const GBuffer gbuffer = surfacesAt([&](int i) { return glm::vec3(endOf(i)); });
  ScatteringGrid ball = varyingMedium(
      1.0f, 0.8f, 0.3f, glm::vec3(-1.0f), 1.0f / 32.0f, glm::ivec3(64),
      [](const glm::vec3& place) { return glm::clamp((0.6f - glm::length(place)) / 0.1f, 0.0f, 1.0f); });
  for (const char* depth : {"volume", "march"})
    for (const float extinction : {1e3f, 1e4f}) {
      ball.media.front().extinction = glm::vec3(extinction);
      const Picture scattered =
          march(builder.scene, ball, gbuffer, 32, {{"light_depth", depth}, {"start", "dithered"}}).scattered;
      double found = 0.0, wanted = 0.0, squares = 0.0;
      int count = 0;
      for (int i = 0; i < kPixels * kPixels; ++i) {
        const glm::dvec3 eye(0, 0, 4), view = glm::normalize(endOf(i) - eye);
        const double along = -glm::dot(eye, view), depthSquared = along * along - 16.0 + kRadius * kRadius;
        if (depthSquared < 0.02) continue;  // within a voxel of the rim
        const glm::dvec3 normal = (eye + view * (along - std::sqrt(depthSquared))) / kRadius;
        const double cosView = -glm::dot(normal, view), cosLight = std::max(0.0, -glm::dot(normal, travel));
        const double radiance =
            0.8 * henyeyGreenstein(0.3, -glm::dot(view, travel)) * cosLight / (cosLight + cosView);
        found += valueOf(scattered, i);
        wanted += radiance;
        squares += std::pow(valueOf(scattered, i) - radiance, 2.0);
        ++count;
      }
      CAPTURE(depth, extinction);
      CHECK(found == Approx(wanted).epsilon(0.02));
      // The surface of the voxels is rough, the more so the thicker they are.
      CHECK(std::sqrt(squares * count) < 0.1 * wanted);
    }
}

TEST_CASE("single scattering of a point light along a ray is its integral within 1 %") {
  // L = int sigma_s p(cos) I / r^2 exp(-sigma_t (t + r)) dt, by Simpson's rule. The ray passes the light at
  // 0.4 m.
  for (const float g : {0.0f, 0.7f, -0.5f}) {
    SceneBuilder builder;
    builder.scene = emptyScene();
    builder.light(LightKind::point, glm::vec3(10.0f), {0, 0.4, -2});
    const glm::vec3 extinction(0.2f, 0.6f, 1.5f);
    const ScatteringGrid fog = evenMedium(extinction, glm::vec3(0.9f), g, glm::vec3(-4), glm::vec3(4));
    const GBuffer gbuffer = surfacesAt([](int) { return glm::vec3(0, 0, -3.5f); });
    for (const int steps : {32, 128}) {
      const Marched result = march(builder.scene, fog, gbuffer, steps);
      for (int channel = 0; channel < 3; ++channel) {
        constexpr int kPieces = 4000;
        double sum = 0.0;
        for (int i = 0; i <= kPieces; ++i) {
          const double t = 3.5 * i / kPieces, along = 2.0 - t, r = std::hypot(along, 0.4);
          const double weight = i == 0 || i == kPieces ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
          sum += weight * henyeyGreenstein(g, along / r) / (r * r) *
                 std::exp(-double(extinction[channel]) * (t + r));
        }
        const double expected = double(extinction[channel]) * 0.9 * 10.0 * sum * 3.5 / kPieces / 3.0;
        CAPTURE(g, steps, channel, expected);
        CHECK(valueOf(result.scattered, kPixels * 9 + 5, channel) == Approx(expected).epsilon(0.01));
      }
    }
  }
}

TEST_CASE(
    "the phase function integrates to 1 within 1e-4 for g from -0.99 to 0.99; as published to (1-g)/(1+g)") {
  // Thin medium, one step: L = sigma_s p(cos) E d. Pixel i looks at an angle to the light of cosine
  // mu = +-(1 - 2 t^3), which puts many of the angles into the narrow lobe; int p dmu by the midpoint rule in
  // t.
  constexpr float kThin = 1e-6f;
  constexpr int kCount = kPixels * kPixels;
  for (const double g : {-0.99, -0.9, -0.4, 0.0, 0.4, 0.9, 0.99}) {
    SceneBuilder builder;
    builder.scene = emptyScene();
    builder.light(LightKind::directional, glm::vec3(1.0f), {}, {0, 0, 1});
    const double side = g < 0.0 ? -1.0 : 1.0;
    const GBuffer gbuffer = surfacesAt([&](int i) {
      const double t = (i + 0.5) / kCount, rest = 2.0 * t * t * t;  // 1 - |mu|, kept exact
      const double mu = side * (1.0 - rest), sine = std::sqrt(rest * (2.0 - rest));
      // The light travels to +z, so the way to it is -z: cosine of the view direction with -z.
      return glm::vec3(glm::dvec3(sine, 0.0, -mu));
    });
    for (const char* form : {"normalised", "as_published"}) {
      const ScatteringGrid fog =
          evenMedium(glm::vec3(kThin), glm::vec3(1.0f), static_cast<float>(g), glm::vec3(-2), glm::vec3(2));
      const Marched result = march(builder.scene, fog, gbuffer, 1, {{"phase", form}});
      double sum = 0.0;
      for (int i = 0; i < kCount; ++i) {
        const double t = (i + 0.5) / kCount;
        sum += 2.0 * kPi * valueOf(result.scattered, i) / kThin * 6.0 * t * t / kCount;
      }
      CAPTURE(g, form);
      const double factor = std::strcmp(form, "normalised") == 0 ? 1.0 : (1.0 - g) / (1.0 + g);
      CHECK(sum == Approx(factor).epsilon(1e-4));
    }
  }
}

TEST_CASE("particles on the device are those of the scene, bit for bit, at any time") {
  const Scene scene = smokeScene(smokeMedium());
  for (const double time : {0.0, 0.4, 2.9999, 3.0, 100000.25, -1.0}) {
    PassHarness harness(device(), techniques(), "volumetric_smoke", "particles", scene,
                        snapshotOf(scene, time));
    harness.run();
    const auto offsets =
        harness.output<Particles>("particles").groups.front().offsets->downloadValues<glm::vec4>();
    const ParticleClock clock = particleClock(scene.media.front(), time);
    for (std::uint32_t i = 0; i < 3000; ++i) {
      const glm::vec4 expected = particleAt(scene.media.front(), clock, i);
      REQUIRE(offsets[i] == expected);
    }
  }
}

TEST_CASE("inserting particles keeps their mass, in coarse and fine grids, and gives the same bits again") {
  const Scene scene = smokeScene(smokeMedium());
  const double expected = 3000 * particleMass(scene.media.front());
  for (const int resolution : {8, 16, 48}) {
    const ScatteringGrid first = inserted(scene, 1.3, resolution), second = inserted(scene, 1.3, resolution);
    CHECK(massOf(first.media.front()) == Approx(expected).epsilon(1e-6));
    CHECK(first.media.front().density->downloadFloats(0) == second.media.front().density->downloadFloats(0));
  }
}

TEST_CASE("a fine grid holds the density of the clouds") {
  const Scene scene = smokeScene(smokeMedium());
  const ScatteringGrid grid = inserted(scene, 2.0, 96);
  const ScatteringGrid::Medium& medium = grid.media.front();
  const std::vector<float> density = medium.density->downloadFloats(0);
  const Medium& source = scene.media.front();
  const ParticleClock clock = particleClock(source, 2.0);
  const glm::dvec3 origin = snapshotOf(scene, 2.0).origin;
  double squared = 0.0, truth = 0.0;
  for (int z = 5; z < medium.grid.resolution.z; z += 7)
    for (int y = 5; y < medium.grid.resolution.y; y += 7)
      for (int x = 5; x < medium.grid.resolution.x; x += 7) {
        const glm::dvec3 centre = origin + glm::dvec3(medium.grid.low) +
                                  double(medium.grid.voxelSize) * (glm::dvec3(x, y, z) + 0.5);
        double expected = 0.0;
        for (std::uint32_t i = 0; i < 3000; ++i) {
          const glm::dvec3 path =
              (centre - source.source - glm::dvec3(particleAt(source, clock, i))) / source.radius;
          expected += std::pow(std::max(0.0, 1.0 - glm::dot(path, path)), 3.0);
        }
        const auto index =
            static_cast<std::size_t>((z * medium.grid.resolution.y + y) * medium.grid.resolution.x + x);
        squared += std::pow(density[index] - expected, 2.0);
        truth += expected * expected;
      }
  CHECK(std::sqrt(squared / truth) < 0.01);
}

TEST_CASE("nothing is inserted into solid voxels, and what they would have held stays in the free ones") {
  Medium large = smokeMedium();
  large.radius = 0.25;  // every cloud reaches out of a slab of 0.25 m
  const Scene scene = smokeScene(large);
  OccupancyGrid space;
  space.grid = {glm::vec3(-2.0f), 0.25f, glm::ivec3(16)};
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d3;
  description.format = gpu::Format::r8;
  description.width = description.height = description.depth = 16;
  space.opacity = std::make_shared<gpu::Texture>(device(), description, "test occupancy");
  std::vector<float> solid(16 * 16 * 16, 0.0f);
  for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = i / 16 % 16 == 8 ? 1.0f : 0.0f;  // 0 < y < 0.25
  space.opacity->uploadFloats(0, solid);
  const ScatteringGrid grid = inserted(scene, 1.3, 64, &space);
  const ScatteringGrid::Medium& medium = grid.media.front();
  const std::vector<float> density = medium.density->downloadFloats(0);
  int blocked = 0;
  std::size_t i = 0;
  for (int z = 0; z < medium.grid.resolution.z; ++z)
    for (int y = 0; y < medium.grid.resolution.y; ++y)
      for (int x = 0; x < medium.grid.resolution.x; ++x, ++i) {
        const float height = medium.grid.low.y + (static_cast<float>(y) + 0.5f) * medium.grid.voxelSize;
        if (height <= 0.001f || height >= 0.249f) continue;
        CHECK(density[i] == 0.0f);
        ++blocked;
      }
  CHECK(blocked > 100);
  CHECK(massOf(medium) == Approx(3000 * particleMass(scene.media.front())).epsilon(1e-6));
}

TEST_CASE("light depths in a volume give the picture of marching to the light from every step") {
  SceneBuilder builder;
  builder.scene = smokeScene(smokeMedium());
  builder.light(LightKind::point, glm::vec3(4.0f), {1.0, 1.0, 1.0});
  builder.light(LightKind::directional, glm::vec3(2.0f), {}, {0.4, -1, 0.1});
  builder.scene.cameras.front().eye = {0, 0, 3};
  const ScatteringGrid grid = inserted(builder.scene, 0.0, 48);
  const GBuffer gbuffer = surfacesAt([](int i) {
    return glm::vec3(2.0f * static_cast<float>(i % kPixels) / kPixels - 1.0f,
                     1.0f - 2.0f * static_cast<float>(i / kPixels) / kPixels, -1.0f);
  });
  const Picture marched = march(builder.scene, grid, gbuffer, 32, {{"light_depth", "march"}}).scattered;
  // What is near is integrated; trilinear interpolation of the rest: a finer grid errs less.
  double errors[2];
  for (const int level : {0, 1}) {
    const Picture volume =
        march(builder.scene, grid, gbuffer, 32, {}, {{"light_resolution", 32 << level}}).scattered;
    double squared = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < volume.values().size(); ++i) {
      squared += std::pow(volume.values()[i] - marched.values()[i], 2.0);
      sum += std::pow(marched.values()[i], 2.0);
    }
    CHECK(sum > 0.0);
    errors[level] = std::sqrt(squared / sum);
  }
  CAPTURE(errors[0], errors[1]);

  CHECK(errors[0] < 0.01);
  CHECK(errors[1] < 0.006);
}

TEST_CASE("surfaces are lit through the medium: E exp(-sigma_t d)") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.6f));
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0, -1, 0});
  builder.look({0, 3, 0.01}, {0, 0, 0}, {0, 1, 0}, 0.3, 16, 16);
  Medium fog;
  fog.extinction = {0.3f, 1.0f, 2.0f};
  fog.box.emplace(glm::dvec3(-2, 0, -2), glm::dvec3(2, 0.7, 2));
  builder.scene.media.push_back(fog);
  const Picture direct = renderOnce(builder.scene, pipeline("volumetric_smoke")).outputs.at("direct");
  for (int channel = 0; channel < 3; ++channel)
    CHECK(direct.at(8, 8, channel) ==
          Approx(0.6 / kPi * 3.0 * std::exp(-0.7 * fog.extinction[channel])).epsilon(0.001));
}

TEST_CASE("cones see the medium: an environment seen through d metres of it is dimmed by exp(-sigma_t d)") {
  Scene scene = emptyScene();
  scene.environment = glm::vec3(1.0f);
  GBuffer gbuffer = surfacesAt([](int) { return glm::vec3(0.0f); });
  const std::vector<glm::vec4> up(kPixels * kPixels, glm::vec4(0, 1, 0, 1)),
      white(kPixels * kPixels, glm::vec4(1.0f));
  gbuffer.normal = gbuffer.geometricNormal = image(up);
  gbuffer.diffuse = image(white);
  RadianceGrid grid;
  grid.grid = {glm::vec3(-2.0f), 0.25f, glm::ivec3(16)};
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d3;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = description.depth = 16;
  description.levels = 5;
  grid.radiance = std::make_shared<gpu::Texture>(device(), description, "test grid");
  grid.radiance->clear(glm::vec4(0.0f));
  // A slab above the surface: along the slanted cone of one direction the way through it is 0.5 m / cos 45
  // deg.
  const glm::vec3 extinction(0.3f, 1.0f, 3.0f);
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "gather", scene, snapshotOf(scene, 0.0));
  harness.setParameter("cones", 1);
  harness.setInput("gbuffer", gbuffer);
  harness.setInput("grid", grid);
  harness.setInput("media", evenMedium(extinction, glm::vec3(0.5f), 0, {-50, 1, -50}, {50, 1.5f, 50}));
  harness.run();
  const Picture diffuse = pictureOf(*harness.output<Image>("diffuse").texture);
  for (int channel = 0; channel < 3; ++channel)
    CHECK(diffuse.at(5, 5, channel) ==
          Approx(std::exp(-0.5 / std::sqrt(0.5) * extinction[channel])).epsilon(0.001));
}

TEST_CASE("smoke at half resolution is that at full resolution, to a FLIP below 0.05") {
  const Scene scene = committed("smoke");
  const Pipeline text = pipeline("volumetric_smoke");
  RenderOptions half = sized(128), full = sized(128);
  half.wanted = full.wanted = {"scattered", "final"};
  full.parameters = text.settings({"pixels=full"});
  const FrameResult a = frameAt(scene, text, half, 3.0), b = frameAt(scene, text, full, 3.0);
  for (const char* output : {"scattered", "final"}) {
    CAPTURE(output);
    CHECK(compare(a.outputs.at(output), b.outputs.at(output)).flip < 0.05);
  }
}

TEST_CASE("a frame made alone is the frame of a sequence") {
  const Scene scene = committed("smoke");
  const Pipeline text = pipeline("volumetric_smoke");
  PipelineExecutor sequence(device(), techniques(), scene, text, sized(48));
  for (const double time : {0.0, 1.0}) sequence.render(time);
  const FrameResult last = sequence.render(2.5, 2);
  const FrameResult alone = frameAt(scene, text, sized(48), 2.5);
  for (const auto& [name, picture] : last.outputs) {
    CAPTURE(name);
    CHECK(picture.values() == alone.outputs.at(name).values());
  }
}

TEST_CASE("a scene without media pays nothing: the passes are left out and the picture keeps its bits") {
  const Scene scene = committed("cornell_glossy");
  const Pipeline smoke = pipeline("volumetric_smoke"), clear = pipeline("voxel_cone_tracing");
  RenderOptions options = sized(48);
  PipelineExecutor executor(device(), techniques(), scene, smoke, options);
  const FrameResult pruned = executor.render(0.0);
  for (const PassRecord& pass : pruned.passes) CHECK(pass.technique != "volumetric_smoke");
  int leftOut = 0;
  for (const LeftOut& one : executor.explain().leftOut)
    leftOut += one.level == LeftOut::Level::pass &&
               one.why.find("which the scene does not have") != std::string::npos;
  CHECK(leftOut == 4);
  options.keepEverything = true;
  const FrameResult kept = renderOnce(scene, smoke, options);
  options.keepEverything = false;
  options.parameters = smoke.settings({"resolution=64"});
  RenderOptions plain = sized(48);
  const FrameResult without = renderOnce(scene, clear, plain);
  CHECK(pruned.outputs.at("final").values() == kept.outputs.at("final").values());
  CHECK(pruned.outputs.at("indirect_diffuse").values() == without.outputs.at("indirect_diffuse").values());
}

TEST_CASE("with media, leaving out changes no bit") {
  for (const char* name : {"smoke", "fog"}) {
    const Scene scene = committed(name);
    RenderOptions options = sized(40);
    const FrameResult pruned = frameAt(scene, pipeline("volumetric_smoke"), options, 2.0);
    options.keepEverything = true;
    const FrameResult kept = frameAt(scene, pipeline("volumetric_smoke"), options, 2.0);
    for (const auto& [output, picture] : pruned.outputs) {
      CAPTURE(name, output);
      CHECK(picture.values() == kept.outputs.at(output).values());
    }
  }
}

TEST_CASE("scattering in smoke and fog is that of the path tracer", "[slow]") {
  for (const char* name : {"smoke", "fog"}) {
    CAPTURE(name);
    const Scene scene = committed(name);
    ReferenceOptions truthOptions;
    truthOptions.width = truthOptions.height = 64;
    truthOptions.samplesPerPixel = 384;
    truthOptions.time = 3.0;
    truthOptions.progress = false;
    const LayeredPicture truth = cachedReference(scene, truthOptions);
    const Picture& single = truth.layers.at("scattered_single");
    const Picture& variance = truth.layers.at("scattered_single.variance");
    const double nothing = compare(Picture(64, 64, 3), single, variance).rmse.value;
    const Pipeline text = pipeline("volumetric_smoke");
    // Grid and picture resolution bring the energy to the truth's; the default is near.
    for (const bool fine : {false, true}) {
      RenderOptions options = sized(64);
      if (fine) options.parameters = text.settings({"pixels=full", "smoke_resolution=128", "steps=64"});
      const PictureError error =
          compare(frameAt(scene, text, options, 3.0).outputs.at("scattered"), single, variance);
      // The truth's own noise is a part of the RMSE.
      const double rmse =
          std::sqrt(std::max(0.0, error.rmse.value * error.rmse.value - error.noiseFloor * error.noiseFloor));
      CAPTURE(fine, rmse / nothing);
      CHECK(error.meanRatio.value == Approx(1.0).margin(fine ? 0.02 : 0.05));
      CHECK(rmse < (fine ? 0.15 : 0.25) * nothing);
    }
  }
}
