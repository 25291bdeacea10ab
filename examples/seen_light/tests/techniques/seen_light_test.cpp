// Known light in a grid that the test makes, and a grid that the technique refuses.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "lumivox/gpu/device.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/builder.h"

using namespace lumivox;

namespace {

gpu::Device& device() {
  static gpu::Device instance;
  return instance;
}
TechniqueSet& techniques() {
  static TechniqueSet instance(TechniqueSet::defaultDirectories());
  return instance;
}

/// A floor of albedo 1/4 at y = 0, seen from above.
Scene floorFromAbove() {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.25f));
  builder.look({0, 3, 0}, {0, 0, 0}, {0, 0, -1}, 0.3, 4, 4);
  return builder.scene;
}

/// A grid over [-2, 2]^3 with the same coefficients in all voxels, in the unit 1/2.
ShGrid gridOf(const glm::vec4& coefficients) {
  ShGrid grid;
  grid.quantity = ShGrid::Quantity::radiance;
  grid.unit = 0.5f;
  gpu::TextureDescription description{.kind = gpu::TextureKind::d3, .format = gpu::Format::rgba32f};
  description.width = description.height = description.depth = 4;
  const auto volume = std::make_shared<gpu::Texture>(device(), description, "light of the test");
  volume->clear(coefficients / grid.unit);
  grid.levels.push_back({{glm::vec3(-2.0f), 1.0f, glm::ivec3(4)}, {volume, nullptr, nullptr}});
  return grid;
}

/// The radiance that the floor reflects in the first pixel.
float reflected(const ShGrid& light) {
  const Scene scene = floorFromAbove();
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness gbuffer(device(), techniques(), "direct_lighting", "gbuffer", scene, snapshot),
      show(device(), techniques(), "seen_light", "show", scene, snapshot);
  gbuffer.run();
  show.setInput("gbuffer", gbuffer.output<GBuffer>("gbuffer"));
  show.setInput("light", light);
  show.run();
  return show.output<Image>("diffuse").texture->downloadFloats().front();
}

}  // namespace

TEST_CASE("radiance L from all sides makes a Lambert surface reflect albedo times L") {
  // L = Y00 (1 / (2 sqrt pi)) everywhere.
  const float radiance = 3.0f, y00 = radiance * 2.0f / std::numbers::inv_sqrtpi_v<float>;
  CHECK(reflected(gridOf({y00, 0, 0, 0})) == Approx(0.25 * radiance));
  // A negative Y1-1 band alone gives a floor that faces up a negative irradiance.
  CHECK(reflected(gridOf({0, -1, 0, 0})) == 0.0f);
}

TEST_CASE("light of another quantity, and light in some voxels alone, are refused") {
  ShGrid light = gridOf({1, 0, 0, 0});
  light.quantity = ShGrid::Quantity::flux;
  CHECK_THROWS_WITH(reflected(light), Catch::Contains("'light' contains flux"));
  light.quantity = ShGrid::Quantity::radiance;
  light.readFor = "'voxels six'";
  CHECK_THROWS_WITH(reflected(light),
                    Catch::Contains("'voxels six'") && Catch::Contains("all voxels are read"));
}

TEST_CASE("the pipeline lights a floor below a bright sky by about its albedo") {
  Scene scene = floorFromAbove();
  scene.environment = glm::vec3(2.0f);
  const Pipeline pipeline = Pipeline::load("scenes/pipelines/seen_light.pipeline");
  RenderOptions options;
  options.checkReads = true;
  PipelineExecutor executor(device(), techniques(), scene, pipeline, options);
  const FrameResult frame = executor.render(0.0);
  CHECK(frame.readsFindings == std::vector<std::string>());
  // The sky fills the upper half: its two bands are 1/2 + 3/4 cos, whose irradiance at the floor is that of
  // the whole sky. The tolerance allows for few rays.
  CHECK(frame.outputs.at("indirect_diffuse").at(2, 2, 0) == Approx(0.25 * 2.0).epsilon(0.1));
}
