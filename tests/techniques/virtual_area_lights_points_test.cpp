// The points pass: what it hands to the device, when it runs, and what it refuses.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "../../techniques/virtual_area_lights/points/surface_points_port.h"
#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::virtual_area_lights;

namespace {

/// A dull floor and a shiny panel, which turns.
Scene floorAndPanel() {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  Object& panel = builder.quad({-0.5f, 0.25f, 0}, {1, 0, 0}, {0, 1, 0}, builder.phong(0.1f, 0.4f, 70.0f));
  panel.motion = RigidMotion{};
  panel.motion->angularSpeed = 0.5 * std::numbers::pi;
  builder.light(LightKind::directional, glm::vec3(1.0f), {}, {0, -1, 0.2});
  builder.look({0, 0.5, 3}, {0, 0.4, 0}, {0, 1, 0}, 0.7, 16, 16);
  return builder.scene;
}

SurfacePoints pointsOf(const Scene& scene, int count, double time = 0.0) {
  return LonePass("virtual_area_lights.points", scene, {{"points", count}}, time)
      .out<SurfacePoints>("points");
}

std::vector<glm::vec4> texelsOf(const gpu::TextureRef& texture) {
  const std::vector<float> floats = texture->downloadFloats(0);
  std::vector<glm::vec4> texels(floats.size() / 4);
  std::memcpy(texels.data(), floats.data(), floats.size() * sizeof(float));
  return texels;
}

/// The pass alone; images so that there is something to render.
Pipeline pointsAlone() {
  return Pipeline::parse(
      "pipeline \"points alone\" {\n"
      "  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass shadow direct_lighting.shadow_map { }\n"
      "  pass direct direct_lighting.shade {\n    gbuffer gbuffer\n    shadow shadow.depth\n  }\n"
      "  pass points virtual_area_lights.points {\n    points 100\n"
      "  }\n  output direct direct.radiance\n}\n",
      "points_alone.pipeline");
}

}  // namespace

TEST_CASE(
    "a texel of each texture tells where a point is, where it faces, its model, width, gloss and side") {
  const Scene scene = floorAndPanel();
  const SurfacePoints points = pointsOf(scene, 1500, 1.0);
  REQUIRE(points.count == 1500);
  const std::vector<glm::vec4> positions = texelsOf(points.position), normals = texelsOf(points.normal),
                               radii = texelsOf(points.radius);
  REQUIRE(positions.size() == 2048);
  REQUIRE(points.state->position.size() == 1500);
  int moving = 0, backs = 0;
  for (std::size_t i = 0; i < 1500; ++i) {
    const SurfacePoint& point = points.set->points[i];
    REQUIRE(positions[i] == glm::vec4(points.state->position[i], points.state->area[i]));
    REQUIRE(glm::vec3(normals[i]) == points.state->normal[i]);
    // After a quarter of a turn the panel, of a fifth of the area, faces along x.
    const bool onPanel = normals[i].w == 1.0f;
    REQUIRE((onPanel || normals[i].w == 0.0f));
    REQUIRE(std::abs(onPanel ? normals[i].x : normals[i].y) == Approx(1.0f));
    REQUIRE(radii[i] == glm::vec4(points.state->radius[i], onPanel ? 70.0f : 1.0f, onPanel ? 1.0f : 0.0f,
                                  point.back ? 0.0f : 1.0f));
    moving += onPanel ? 1 : 0;
    backs += point.back ? 1 : 0;
  }
  CHECK(moving == 300);
  CHECK(backs == 750);
  for (std::size_t i = 1500; i < positions.size(); ++i)
    REQUIRE(
        (positions[i] == glm::vec4(0.0f) && normals[i] == glm::vec4(0.0f) && radii[i] == glm::vec4(0.0f)));
}

TEST_CASE("the device holds the grid of the points at that time") {
  const Scene scene = floorAndPanel();
  const SurfacePoints points = pointsOf(scene, 300, 0.7);
  const SurfacePointGrid grid = gridOf(*points.set, *points.state);
  CHECK(points.grid == grid.placement);
  CHECK(points.cells->downloadValues<std::uint32_t>() == grid.first);
  CHECK(points.candidates->downloadValues<std::uint32_t>() == grid.points);
}

TEST_CASE(
    "points are made when something wants them, once while nothing moves, and spread once for all times") {
  Scene scene = floorAndPanel();
  // Nothing wants them.
  PipelineExecutor unwanted(device(), techniques(), scene, pointsAlone(), sized(16, 16));
  CHECK_FALSE(ran(unwanted.render(0.0), "points"));
  PipelineExecutor moving(device(), techniques(), scene, pointsAlone(), sized(16, 16));
  moving.keepOutput("points", "points");
  const auto points = [](const PipelineExecutor& executor) {
    return kept<SurfacePoints>(executor, "points", "points");
  };
  CHECK(ran(moving.render(0.0, 0), "points"));
  const SurfacePoints first = points(moving);
  CHECK_FALSE(ran(moving.render(0.0, 1), "points"));
  CHECK(ran(moving.render(0.5, 2), "points"));
  const SurfacePoints second = points(moving);
  CHECK(second.set == first.set);
  CHECK(second.state->position != first.state->position);
  CHECK(reused(moving, "surface points"));
  // A frame alone is that of the sequence.
  PipelineExecutor alone(device(), techniques(), scene, pointsAlone(), sized(16, 16));
  alone.keepOutput("points", "points");
  alone.render(0.5);
  CHECK(points(alone).position->download(0) == second.position->download(0));
  CHECK(points(alone).candidates->download() == second.candidates->download());
  scene.objects[1].motion.reset();
  PipelineExecutor still(device(), techniques(), scene, pointsAlone(), sized(16, 16));
  still.keepOutput("points", "points");
  CHECK(ran(still.render(0.0, 0), "points"));
  CHECK_FALSE(ran(still.render(0.5, 1), "points"));
}

TEST_CASE(
    "where there is no triangle all light of points is left out, or nothing, when nothing is left out") {
  const Scene nothing = loadScene(sourceDirectory() / "scenes/stress/no_triangles.scene");
  const Pipeline ours = pipeline("virtual_area_lights"),
                 published = Pipeline::load(
                     sourceDirectory() /
                     "scenes/pipelines/virtual_area_lights/virtual_area_lights_as_published.pipeline");
  for (const Pipeline* made : {&ours, &published})
    for (const bool everything : {false, true}) {
      RenderOptions options = sized(16, 16);
      options.keepEverything = everything;
      PipelineExecutor executor(device(), techniques(), nothing, *made, options);
      const FrameResult frame = executor.render(0.0);
      CAPTURE(made->name, everything);
      // The environment alone.
      const ImageBuffer image = frame.outputs.at("final"), light = frame.outputs.at("indirect_diffuse");
      for (int c = 0; c < 3; ++c)
        CHECK(image.at(7, 7, c) == Approx(std::array{0.25, 0.5, 1.0}[static_cast<std::size_t>(c)]));
      for (const float value : light.values()) CHECK(value == 0.0f);
      CHECK(ran(frame, "points") == everything);
    }
  CHECK(pointsOf(nothing, 10).count == 0);
}

TEST_CASE("more points than there is room for are refused before anything is taken") {
  const Scene scene = floorAndPanel();
  gpu::Device tight({.memoryBytes = 8u << 20});
  PassHarness harness(tight, techniques(), "virtual_area_lights", "points", scene, snapshotOf(scene, 0.0));
  harness.setParameter("points", 131072);
  // 48 bytes in textures, 32 and 480 in the grid.
  CHECK_THROWS_MATCHES(harness.run(), Error, Tells(131072, "70.0 MiB", 8192));
}

TEST_CASE("a point for each side is enough to be found, and a mesh without area has none") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  const SurfacePoints two = pointsOf(builder.scene, 1);
  CHECK(two.count == 2);
  CHECK(two.candidates->downloadValues<std::uint32_t>().size() >= 2);
  SceneBuilder flat;
  flat.mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, flat.lambert(0.5f));
  const SurfacePoints none = pointsOf(flat.scene, 100);
  CHECK(none.count == 0);
  CHECK(none.cells->downloadValues<std::uint32_t>() == std::vector<std::uint32_t>{0, 0});
}
