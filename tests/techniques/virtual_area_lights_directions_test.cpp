// Lights one by one and the sky, by the nearest disc in each direction of a point.
#include <cmath>

#include "../../techniques/virtual_area_lights/directions/point_sight.h"
#include "support/glsl_functions.h"
#include "support/virtual_area_lights.h"

using namespace lumivox;
using namespace lumivox::test;
using virtual_area_lights::PointSight;

namespace {

const Settings kByDirection{{"visibility", "directions"}};

/// A scene of one light and this constant environment.
Scene under(const glm::vec3& environment) {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.phong(0.5f, 0.5f, 10.0f));
  builder.light(LightKind::point, glm::vec3(1.0f), {0, 1, 0});
  builder.look({0, 1, 0}, {0, 0, 1e-3}, {0, 0, -1}, 0.7, 8, 8);
  builder.scene.environment = environment;
  return builder.scene;
}

/// Radiance that a white first point reflects by its diffuse lobe.
glm::vec3 reflected(const std::vector<SparsePoint>& points, const std::vector<DiscLight>& lights,
                    const glm::vec3& environment = glm::vec3(0.0f), const Settings& look = {}) {
  const Scene scene = under(environment);
  const SurfacePoints where = pointsOf(points);
  const auto sight =
      LonePass("virtual_area_lights.look", scene, look).in("points", where).out<PointSight>("sight");
  LonePass gather("virtual_area_lights.gather", scene, kByDirection);
  gather.in("points", where).in("sight", sight);
  if (!lights.empty()) gather.in("lights", lightsOf(lights));
  return glm::vec3(valuesOf(gather.out<SparseLight>("light").diffuse, 1).front());
}

SparsePoint disc(const glm::vec3& position, const glm::vec3& normal, float radius) {
  return {position, normal, 0.01f, radius};
}
/// What one light overhead, at a height of 2, gives with these discs, as a share of what it gives without.
float shown(const std::vector<SparsePoint>& discs) {
  const std::vector<DiscLight> light{{{0, 2, 0}, {0, -1, 0}}};
  std::vector<SparsePoint> points{SparsePoint{}};
  const float all = reflected(points, light).x;
  points.insert(points.end(), discs.begin(), discs.end());
  return reflected(points, light).x / all;
}

}  // namespace

TEST_CASE("without discs each light gives by direction what it gives unoccluded, to the bit") {
  const std::vector<DiscLight> lights = shiningBox(3);
  const SurfacePoints points = pointsOf({SparsePoint{}});
  const glm::vec4 plain = valuesOf(SparsePasses().gather(points, lightsOf(lights)).diffuse, 1).front();
  CHECK(reflected({SparsePoint{}}, lights) == glm::vec3(plain));
}

TEST_CASE(
    "a light behind a disc gives nothing, one before it or on it gives all, and backs occlude nothing") {
  CHECK(shown({disc({0, 1, 0}, {0, -1, 0}, 1.0f)}) == 0.0f);
  CHECK(shown({disc({0, 3, 0}, {0, -1, 0}, 2.0f)}) == 1.0f);
  CHECK(shown({disc({0, 2, 0}, {0, -1, 0}, 2.0f)}) == 1.0f);
  // A curved surface: the light lies behind the plane of a neighbour's disc by a tenth of its radius.
  CHECK(shown({disc({0, 1.9f, 0}, {0, -1, 0}, 1.0f)}) == 1.0f);
  CHECK(shown({disc({0, 1, 0}, {0, 1, 0}, 2.0f)}) == 1.0f);
  CHECK(shown({disc({0, -1, 0}, {0, 1, 0}, 2.0f)}) == 1.0f);
  CHECK(shown({disc({1.5f, 1, 0}, {0, -1, 0}, 0.5f)}) == 1.0f);
}

TEST_CASE("behind a wall of discs all lights are hidden, and none of those before it") {
  std::vector<SparsePoint> points{SparsePoint{{0, 0, 0}, {1, 0, 0}}};
  for (int y = -20; y <= 20; ++y)
    for (int z = -20; z <= 20; ++z)
      points.push_back(
          disc({1, 0.5f * static_cast<float>(y), 0.5f * static_cast<float>(z)}, {-1, 0, 0}, 0.4f));
  std::vector<DiscLight> behind, before;
  for (int i = -3; i <= 3; ++i) {
    behind.push_back({{2, 0.4f * static_cast<float>(i), 0.3f}, {-1, 0, 0}});
    before.push_back({{0.7f, 0.1f * static_cast<float>(i), 0.1f}, {-1, 0, 0}});
  }
  CHECK(reflected(points, behind) == glm::vec3(0.0f));
  CHECK(reflected(points, before) == reflected({points.front()}, before));
}

TEST_CASE("of two discs in line the nearer one is kept, in either order") {
  const SparsePoint near = disc({0, 1, 0}, {0, -1, 0}, 1.0f), far = disc({0, 4, 0}, {0, -1, 0}, 3.0f);
  CHECK(shown({near, far}) == 0.0f);
  CHECK(shown({far, near}) == 0.0f);
}

TEST_CASE("each light is hidden by itself and keeps its colour") {
  const std::vector<DiscLight> lights{{{-2, 2, 0}, glm::normalize(glm::vec3(1, -1, 0)), 0.01f, {1, 0, 0}},
                                      {{2, 2, 0}, glm::normalize(glm::vec3(-1, -1, 0)), 0.01f, {0, 1, 0}}};
  const glm::vec3 both = reflected({SparsePoint{}}, lights),
                  one = reflected(
                      {SparsePoint{}, disc({-1, 1, 0}, glm::normalize(glm::vec3(1, -1, 0)), 0.9f)}, lights);
  CHECK(both.x == Approx(both.y));
  CHECK(one == glm::vec3(0.0f, both.y, 0.0f));
}

TEST_CASE(
    "a constant environment without occluders is reflected as it is, in any direction, without lights too") {
  const glm::vec3 sky(0.3f, 1.0f, 2.0f);
  for (const glm::vec3& way : {glm::vec3(0, 1, 0), {1, 0.2f, -0.4f}, {0, -1, 0}}) {
    const SparsePoint point{{0.2f, 0.1f, 0.3f}, glm::normalize(way)};
    const glm::vec3 found = reflected({point}, {}, sky);
    CAPTURE(way.x, way.y, way.z);
    for (int c = 0; c < 3; ++c) CHECK(found[c] == Approx(sky[c]).epsilon(1e-5));
  }
  const std::vector<DiscLight> light{{{0, 2, 0}, {0, -1, 0}}};
  CHECK(reflected({SparsePoint{}}, light, sky).x ==
        Approx(0.3f + reflected({SparsePoint{}}, light).x).epsilon(1e-5));
}

TEST_CASE("a wall at a point's side halves the sky, and a ceiling of discs takes all of it") {
  for (const glm::vec3& side : {glm::vec3(1, 0, 0), {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}})
    CHECK(reflected({SparsePoint{}, disc(0.01f * side, -side, 1000.0f)}, {}, glm::vec3(1.0f)).x ==
          Approx(0.5f).epsilon(1e-5));
  CHECK(reflected({SparsePoint{}, disc({0, 1, 0}, {0, -1, 0}, 1000.0f)}, {}, glm::vec3(1.0f)) ==
        glm::vec3(0.0f));
}

TEST_CASE("with 'occlusion off' discs hide nothing, and there is no sky") {
  const std::vector<DiscLight> light{{{0, 2, 0}, {0, -1, 0}}};
  const SparsePoint hides = disc({0, 1, 0}, {0, -1, 0}, 2.0f);
  CHECK(reflected({SparsePoint{}, hides}, light, glm::vec3(1.0f), {{"occlusion", "off"}}) ==
        reflected({SparsePoint{}}, light));
}

TEST_CASE("cells of the square map to the disc and back, with equal areas") {
  std::vector<glm::vec4> places;
  for (int i = 0; i < 64; ++i)
    places.emplace_back((static_cast<float>(i % 8) + 0.3f) / 8.0f, (static_cast<float>(i / 8) + 0.6f) / 8.0f,
                        0, 0);
  const std::vector<glm::vec4> found =
      evaluated({"common/constants.glsl", "virtual_area_lights/directions/sight.glsl"}, R"(
      const float kStep = 1.0 / 256.0;
      vec2 across = discFromSquare(given.xy + vec2(kStep, 0.0)) - discFromSquare(given.xy - vec2(kStep, 0.0));
      vec2 down = discFromSquare(given.xy + vec2(0.0, kStep)) - discFromSquare(given.xy - vec2(0.0, kStep));
      found = vec4(squareFromDisc(discFromSquare(given.xy)),
                   (across.x * down.y - across.y * down.x) / (4.0 * kStep * kStep), 0.0);)",
                places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    CHECK(found[i].x == Approx(places[i].x).margin(1e-5));
    CHECK(found[i].y == Approx(places[i].y).margin(1e-5));
    CHECK(found[i].z == Approx(kPi).epsilon(0.01));
  }
}

TEST_CASE("by direction, 'occlude' passes light unchanged, and 'gather' asks for 'sight'") {
  const SparseLight light = diffuseLight({{1, 1, 1, 1}, {1, 1, 1, 1}}, {{0, 4, 0, 1}, {0, 4, 0, 1}});
  const SurfacePoints points = pointsOf({SparsePoint{}, disc({0, 1, 0}, {0, -1, 0}, 2.0f)});
  CHECK(SparsePasses().occlude(points, light, kByDirection).diffuse == light.diffuse);
  CHECK_THROWS_WITH(SparsePasses().gather(points, lightsOf({DiscLight{}}), kByDirection),
                    Catch::Contains("expected it to be connected to a pass virtual_area_lights.look"));
}

TEST_CASE("points have the sky of a map that was turned while the picture is shown") {
  const Pipeline text = pipeline("virtual_area_lights");
  RenderOptions options = sized(24, 24);
  options.parameters = text.settings({"points=256"});
  const Scene scene = committed("open_air");
  Scene turned = scene;
  auto map = std::make_shared<EnvironmentMap>(*scene.environmentMap);
  map->toMap = glm::mat3(0, 0, -1, 0, 1, 0, 1, 0, 0) * map->toMap;
  map->finish();
  turned.environmentMap = map;
  PipelineExecutor shown(device(), techniques(), scene, text, options),
      fresh(device(), techniques(), turned, text, options);
  const ImageBuffer before = shown.render(0.0).outputs.at("indirect_diffuse");
  shown.setScene(turned);
  const ImageBuffer after = shown.render(0.0).outputs.at("indirect_diffuse");
  CHECK(after.values() == fresh.render(0.0).outputs.at("indirect_diffuse").values());
  CHECK(after.values() != before.values());
}
