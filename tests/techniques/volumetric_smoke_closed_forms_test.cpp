// The march through media against integrals that are known.
#include <algorithm>
#include <cmath>

#include "support/filtered.h"
#include "support/marching.h"

using namespace lumivox;
using namespace lumivox::test;

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

TEST_CASE("voxelized smoke of 10^-3 to 10^5 / m, in 32 steps, scatters what a slab does in closed form") {
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
          // Trilinear densities add outside of the layer as much as they lack inside.
          const double through = extinction * 0.5 / -views[i].z, ratio = views[i].z / travel.z;
          const double wanted = 0.8 * henyeyGreenstein(0.3, -glm::dot(views[i], travel)) * 2.0 /
                                (1.0 + ratio) * -std::expm1(-(1.0 + ratio) * through);
          squares += std::pow(valueOf(result.scattered, i) / wanted - 1.0, 2.0) / (kPixels * kPixels);
          worstTransmittance =
              std::max(worstTransmittance, std::abs(valueOf(result.transmittance, i) - std::exp(-through)));
        }
        CAPTURE(lightAngle, depth, extinction);
        CHECK(std::sqrt(squares) < 0.005);
        CHECK(worstTransmittance < filtered(1e-4f));
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
      const ImageBuffer scattered =
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

TEST_CASE("a point light inside smoke that varies is its integral, marching to it and from the volume") {
  // Density 1/2 + y / 5 in voxels, which trilinear interpolation keeps. Along the ray, at y = 0, it is 1/2;
  // along the way from (0, 0, -t) to the light at height h it is on average that at h / 2. So L = int sigma_s
  // / 2 p I / r^2 exp(-sigma_t (t / 2 + (1/2 + h / 10) r)) dt, by Simpson's rule.
  constexpr double kHeight = 0.4;
  SceneBuilder builder;
  builder.scene = emptyScene();
  builder.light(LightKind::point, glm::vec3(10.0f), {0, kHeight, -2});
  const GBuffer gbuffer = surfacesAt([](int) { return glm::vec3(0, 0, -3.5f); });
  struct Way {
    const char* depth;
    int points;
    double tolerance;
  };
  // Between the points of the volume, over 8 m, the peak of the transmittance at the light is cut off.
  for (const Way& way : {Way{"march", 32, 0.01}, {"volume", 32, 0.06}, {"volume", 64, 0.02}})
    for (const float g : {0.0f, 0.7f})
      for (const float extinction : {0.5f, 3.0f}) {
        const ScatteringGrid smoke = varyingMedium(
            extinction, 0.9f, g, glm::vec3(-4), 0.125f, glm::ivec3(64),
            [](const glm::vec3& place) { return 0.5f + 0.2f * std::clamp(place.y, -2.0f, 2.0f); });
        constexpr int kPieces = 4000;
        double sum = 0.0;
        for (int i = 0; i <= kPieces; ++i) {
          const double t = 3.5 * i / kPieces, along = 2.0 - t, r = std::hypot(along, kHeight);
          const double weight = i == 0 || i == kPieces ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
          sum += weight * henyeyGreenstein(g, along / r) / (r * r) *
                 std::exp(-double(extinction) * (0.5 * t + (0.5 + 0.1 * kHeight) * r));
        }
        const double expected = double(extinction) * 0.5 * 0.9 * 10.0 * sum * 3.5 / kPieces / 3.0;
        const ImageBuffer found = march(builder.scene, smoke, gbuffer, 128,
                                        {{"light_depth", way.depth}, {"light_resolution", way.points}})
                                      .scattered;
        CAPTURE(way.depth, way.points, g, extinction, expected);
        CHECK(valueOf(found, kPixels * 9 + 5) == Approx(expected).epsilon(way.tolerance));
      }
}

TEST_CASE("densities are integrated exactly over as many cells as asked for, along every axis both ways") {
  // One step to a surface 1.5 m away. The four cubes before it, of which the surface halves the first, reach
  // back to 0.625 m, where the densities begin: between centres they are linear, and the rest holds nothing.
  constexpr float kVoxel = 0.25f;
  constexpr double kExtinction = 1.5;
  const auto densityAlong = [](float way) {
    return way > 0.8f && way < 1.5f ? std::round((way - 0.625f) / kVoxel) : 0.0f;  // 1, 2, 3
  };
  const double integral =
      kVoxel * (0.5 * (0.0 + 1.0) + 0.5 * (1.0 + 2.0) + 0.5 * (2.0 + 3.0)) + 0.5 * kVoxel * 0.5 * (3.0 + 1.5);
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      CAPTURE(axis, side);
      glm::vec3 direction(0.0f);
      direction[axis] = side;
      const ScatteringGrid smoke =
          varyingMedium(static_cast<float>(kExtinction), 0.5f, 0.0f, glm::vec3(-2.0f), kVoxel, glm::ivec3(16),
                        [&](const glm::vec3& place) { return densityAlong(glm::dot(place, direction)); });
      const GBuffer gbuffer = surfacesAt([&](int) { return 1.5f * direction; });
      const ImageBuffer through = march(emptyScene(), smoke, gbuffer, 1, {{"cells", 4}}).transmittance;
      CHECK(valueOf(through, 7) == Approx(std::exp(-kExtinction * integral)).epsilon(0.005));
    }
}
