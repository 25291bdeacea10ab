// What the passes give, against the path tracer, other passes and themselves.
#include <cmath>
#include <random>

#include "support/against_reference.h"
#include "support/virtual_area_lights.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("in a closed box of even exitance nowhere on the floor more than 1.01 of it arrives") {
  constexpr int kSide = 32;
  std::vector<SparsePoint> points;
  for (int i = 0; i <= 40; ++i)
    for (int j = 0; j <= i; ++j) {
      // Denser towards the walls and the corner.
      const auto towardsWall = [](int step) {
        return static_cast<float>(1.0 - std::pow(1.0 - step / 40.5, 3.0));
      };
      points.push_back({{towardsWall(i), -1, towardsWall(j)}});
    }
  SparsePasses passes;
  const SparseLight light = passes.gather(pointsOf(points), lightsOf(shiningBox(kSide)));
  for (const glm::vec4& found : valuesOf(light.diffuse, points.size())) {
    CHECK(kPi * static_cast<double>(found.x) <= 1.01);
    CHECK(kPi * static_cast<double>(found.x) >= 0.249);  // in the very corner half of each wall's are edge on
  }
}

TEST_CASE("discs of random places and slants light a floor as emissive polygons do in the path tracer") {
  constexpr int kSide = 8, kCorners = 24;
  constexpr double kHeight = 0.4, kFov = 0.9;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  SceneBuilder builder;
  builder.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, builder.lambert(0.5f));
  const int shining = builder.lambert(0.0f, 1.0f);
  std::vector<DiscLight> lights;
  for (int i = 0; i < 12; ++i) {
    // Beside each other, so that none hides another.
    const glm::vec3 centre(0.3f * static_cast<float>(i % 4) - 0.45f + 0.1f * (unit(random) - 0.5f), 0.8f,
                           0.4f * static_cast<float>(i / 4) - 0.4f + 0.1f * (unit(random) - 0.5f)),
        normal = glm::normalize(glm::vec3(unit(random) - 0.5f, -1.0f, unit(random) - 0.5f)),
        tangent = glm::normalize(glm::cross(normal, glm::vec3(1, 0, 0))),
        binormal = glm::cross(normal, tangent);
    const float radius = 0.02f + 0.05f * unit(random);
    std::vector<glm::vec3> triangles;
    for (int corner = 0; corner < kCorners; ++corner) {
      const auto at = [&](int number) {
        const auto angle = static_cast<float>(2.0 * kPi * number / kCorners);
        return centre + radius * (std::cos(angle) * tangent + std::sin(angle) * binormal);
      };
      triangles.insert(triangles.end(), {centre, at(corner), at(corner + 1)});
    }
    builder.mesh(triangles, shining);
    const double area =
        0.5 * kCorners * std::sin(2.0 * kPi / kCorners) * static_cast<double>(radius * radius);
    lights.push_back({centre, normal, static_cast<float>(area), glm::vec3(static_cast<float>(kPi))});
  }
  builder.look({0, kHeight, 0}, {0, 0, 0}, {0, 0, -1}, kFov, kSide, kSide);
  const LayeredImage reference = renderReference(builder.scene, quietly(1024, 0));
  std::vector<SparsePoint> seen;
  const double half = kHeight * std::tan(0.5 * kFov);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      seen.push_back({{half * (2.0 * (x + 0.5) / kSide - 1.0), 0, half * (2.0 * (y + 0.5) / kSide - 1.0)}});
  SparsePasses passes;
  const ImageBuffer found = passes.bruteForce(lightsOf(lights), seen).first;  // of albedo 1
  double squared = 0.0, all = 0.0, mean = 0.0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double right = reference.layers.at("direct").at(x, y, 0),
                   here = 0.5 * static_cast<double>(found.at(x, y, 0));
      squared += (here - right) * (here - right);
      all += right * right;
      mean += (here / right - 1.0) / (kSide * kSide);
    }
  CAPTURE(std::sqrt(squared / all), mean);
  CHECK(std::sqrt(squared / all) <= 0.015);
  CHECK(std::abs(mean) <= 0.01);
}

TEST_CASE("every light at every pixel is what reflective shadow maps gather of all texels, within 1e-4") {
  const Scene scene = litRoom(12, 12);
  const std::string common =
      "pipeline \"all texels\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass map reflective_shadow_maps.render {\n    area_samples 2\n    area_size 16\n  }\n";
  const auto lightOf = [&](const std::string& passes) {
    return renderOnce(scene, Pipeline::parse(common + passes + "}\n", "all_texels.pipeline"))
        .outputs.at("indirect_diffuse");
  };
  const ImageBuffer
      every = lightOf(
          "  pass choose reflective_shadow_maps.choose {\n    map map.map\n    method stride\n    stride 1\n  }\n"
          "  pass sum virtual_area_lights.brute_force {\n    gbuffer gbuffer\n    lights choose.lights\n  }\n"
          "  output indirect_diffuse sum.diffuse\n"),
      all = lightOf(
          "  pass sum reflective_shadow_maps.gather {\n    gbuffer gbuffer\n    map map.map\n"
          "    method all\n  }\n  output indirect_diffuse sum.diffuse\n");
  double sum = 0.0;
  for (std::size_t i = 0; i < all.values().size(); ++i) {
    REQUIRE(every.values()[i] == Approx(all.values()[i]).epsilon(1e-4).margin(1e-7));
    sum += static_cast<double>(all.values()[i]);
  }
  CHECK(sum > 1.0);
}

TEST_CASE("lights that share the area of an area light's samples cover what it lights once") {
  // A closed room whose lamp lights all of the floor.
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.quad({-0.1f, 1, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, builder.lambert(0.0f, 5.0f));
  builder.look({0, 0.5, 3}, {0, 0.4, 0}, {0, 1, 0}, 0.7, 8, 8);
  const ReflectiveShadowMap map =
      LonePass("reflective_shadow_maps.render", builder.scene).out<ReflectiveShadowMap>("map");
  const auto areaOf = [&](const char* area, const char* method) {
    const SurfaceLights lights =
        LonePass("reflective_shadow_maps.choose", builder.scene, {{"area", area}, {"method", method}})
            .in("map", map)
            .out<SurfaceLights>("lights");
    const auto values = lights.lights->downloadValues<glm::vec4>();
    double sum = 0.0;
    for (int i = 0; i < lights.count; ++i)
      sum += static_cast<double>(values[3 * static_cast<std::size_t>(i)].w);
    return sum;
  };
  CHECK(areaOf("shared", "stride") == Approx(4.0).epsilon(0.01));
  CHECK(areaOf("surface", "stride") == Approx(64.0).epsilon(0.01));
  // Chosen by flux the sum is an estimate: dim places are large.
  CHECK(areaOf("shared", "flux") == Approx(4.0).epsilon(0.1));
}

TEST_CASE("a sheet that is lit on one side is dark on the other") {
  // A sunlit floor lights the lower side of a sheet above it; nothing lights the upper one.
  for (const bool fromBelow : {true, false}) {
    SceneBuilder builder;
    builder.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, builder.lambert(0.5f));
    builder.quad({-0.5f, 0.5f, -0.5f}, {0, 0, 1}, {1, 0, 0}, builder.lambert(0.5f));
    builder.light(LightKind::directional, glm::vec3(3.0f), {}, {1, -1, 0});
    builder.look({0, fromBelow ? 0.1 : 1.2, 0}, {0, 0.5, 0}, {0, 0, -1}, 0.6, 16, 16);
    const double mean =
        meanOf(rendered(builder.scene, pipeline("virtual_area_lights"), {"points=400", "lights=256"})
                   .outputs.at("indirect_diffuse"));
    CHECK((fromBelow ? mean > 0.05 : mean < 1e-6));
  }
}

TEST_CASE("at a foot of a wall, among nearer points of the floor, the wall's own points light it") {
  std::vector<SparsePoint> points;
  for (int i = 0; i < 9; ++i) points.push_back({{0.01f * static_cast<float>(i), 0, 0.01f}, {0, 0, 1}});
  points.push_back({{0, 0.3f, 0}, {0, 1, 0}});
  std::vector<glm::vec4> light(9, glm::vec4(100, 0, 0, 1));
  light.emplace_back(2, 0, 0, 1);
  const SparseLight made = lightOverhead(light);
  SparsePasses passes;
  CHECK(passes.apply(pointsOf(points), made, std::vector<SparsePoint>(64, SparsePoint{})).first.at(0, 0, 0) ==
        Approx(2.0));
}
