// Light between elements of surfaces that stretch and shrink.
#include <algorithm>
#include <cmath>

#include "support/form_factors.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr float kSky = 2.0f;

/// A small floor below a sheet of half side 0.25 m that faces down, 1 m above it, and becomes `later` within
/// 1 s; all of it under a sky.
Scene floorBelow(const std::vector<glm::vec3>& later) {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.quad({-0.1f, 0, -0.1f}, {0, 0, 0.2f}, {0.2f, 0, 0}, grey);
  Object& sheet = builder.quad({-0.25f, 1, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}, grey);
  VertexSequence sequence;
  sequence.framesPerSecond = 1.0;
  const auto* first = &builder.scene.positions[sheet.firstVertex];
  sequence.positions = {std::vector<glm::vec3>(first, first + 4), later};
  sequence.normals.assign(2, std::vector<glm::vec3>(4, glm::vec3(0, -1, 0)));
  sheet.sequence = sequence;
  builder.scene.environment = glm::vec3(kSky);
  return builder.scene;
}

/// Of leaves, front and back in turn, W/m^2.
std::vector<float> irradianceOf(const LinkedScene& linkedScene, const Scene& scene, double time,
                                double bounces) {
  const ElementLight light = LonePass("implicit_visibility.illuminate", scene, {{"bounces", bounces}}, time)
                                 .in("elements", linkedScene.elements)
                                 .in("links", linkedScene.links)
                                 .out<ElementLight>("light");
  for (const gpu::TextureRef& texture : {light.irradiance, light.radiance})
    for (const float value : texture->downloadFloats(0)) REQUIRE(std::isfinite(value));
  std::vector<float> values;
  const std::vector<float> floats = light.irradiance->downloadFloats(0);
  for (int texel = 0; texel < 2 * linkedScene.elements.leafCount; ++texel)
    values.push_back(floats[4 * static_cast<std::size_t>(texel)]);
  return values;
}

/// The share of the sky's light that arrives at the floor.
double skyOverFloor(const Scene& scene, const LinkSettings& settings, double time, double bounces = 1.0) {
  const LinkedScene made = linked(scene, settings, time);
  const std::vector<float> irradiance = irradianceOf(made, scene, time, bounces);
  double sum = 0.0, count = 0.0;
  for (std::uint32_t leaf = 0; leaf < made.tree().leafCount; ++leaf)
    if (made.tree().objectOfNode[leaf] == 0) sum += static_cast<double>(irradiance[2 * leaf]), count += 1.0;
  return sum / count / (kPi * static_cast<double>(kSky));
}

}  // namespace

TEST_CASE("a sheet that shrinks to a point, a line or a place far away casts no shadow and gives no NaN") {
  const std::vector<std::vector<glm::vec3>> ends{
      std::vector<glm::vec3>(4, glm::vec3(0.0f, 1.0f, 0.0f)),
      std::vector<glm::vec3>(4, glm::vec3(0.0f, 0.0f, 0.0f)),  // in the middle of the floor
      {{-1, 1, 0}, {1, 1, 0}, {1, 1, 0}, {-1, 1, 0}},
      std::vector<glm::vec3>(4, glm::vec3(1e5f, 0.0f, 0.0f))};
  for (const std::vector<glm::vec3>& end : ends)
    for (const std::string source : {"atlas", "vertices"})
      for (const std::string method : {"hierarchy", "all_pairs"})
        for (const std::string push : {"rebinned", "kept"}) {
          CAPTURE(end[1].x, end[1].y, source, method, push);
          const LinkSettings settings{
              {{"elements", 64}, {"source", source}}, {{"method", method}}, {{"push", push}}};
          CHECK(skyOverFloor(floorBelow(end), settings, 1.0, 2.0) == Approx(1.0).epsilon(1e-4));
        }
  // What has not shrunk hides the sky.
  CHECK(skyOverFloor(floorBelow(ends[0]), {{{"elements", 64}}, {{"bins", 16}}, {}}, 0.0) ==
        Approx(1.0 - squareAbove(0.25)).margin(0.03));
}

TEST_CASE(
    "a sheet that stretches hides the sky with areas of the moment, and has holes with those of the rest") {
  // Six times as wide each way.
  const Scene scene = floorBelow({{-1.5f, 1, -1.5f}, {1.5f, 1, -1.5f}, {1.5f, 1, 1.5f}, {-1.5f, 1, 1.5f}});
  const double hidden = squareAbove(1.5);
  const auto sky = [&](const std::string& source, const std::string& areas) {
    return skyOverFloor(
        scene,
        {{{"elements", 800}, {"share", 0.5}, {"source", source}, {"areas", areas}}, {{"bins", 16}}, {}}, 1.0);
  };
  const double now = sky("atlas", "now"), rest = sky("atlas", "rest");
  CAPTURE(hidden, now, rest);
  CHECK(now == Approx(1.0 - hidden).margin(0.1));
  // Discs of 1/36 of the area, of which those of a square cover pi / 2 of it.
  CHECK(1.0 - rest < 0.1 * hidden);
}
