// Layered reflective shadow maps on committed scenes, against the path-traced reference and beside cone
// tracing through the same voxels with the same cones.
#include <cmath>

#include "lumivox/base/file.h"
#include "support/against_reference.h"
#include "support/kept_table.h"
#include "support/layered_maps.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// The Cornell box under another light than its lamp.
Scene cornellUnder(LightKind kind) {
  Scene scene = committed("cornell");
  for (Material& material : scene.materials) material.emission = glm::vec3(0.0f);
  Light light;
  light.name = "other";
  light.kind = kind;
  light.power = glm::vec3(3.0f);
  light.position = {0.278, 0.54, 0.1};
  light.direction = kind == LightKind::spot ? glm::dvec3(0.1, -1.0, 0.35) : glm::dvec3(0.3, -0.5, 1.0);
  light.innerAngle = 0.436, light.outerAngle = 0.611;
  scene.lights = {light};
  return scene;
}

Against errorOf(const Scene& scene, const Picture& picture, const Pipeline& text,
                const std::vector<std::string>& settings = {}) {
  // Not of the cache, which knows committed scenes.
  ReferenceOptions options = quietly(picture.referenceSamples, 1);
  options.width = picture.width;
  options.height = picture.height;
  return lightAgainst(renderReference(scene, options),
                      pictured(scene, picture, text, settings).outputs.at("indirect_diffuse"));
}

/// The committed pipeline in its published form.
Pipeline asPublished() {
  const Pipeline text = pipeline("layered_reflective_shadow_maps");
  std::string source = text.document->source;
  for (const char* pass : {"maps.occlusion {", "maps.layers {", "maps.gather {"})
    source.insert(source.find(pass) + std::string(pass).size(), "\n    as_published on\n");
  return Pipeline::parse(source, text.file);
}

}  // namespace

TEST_CASE(
    "under a spot light layered maps err at most 1.2 times as much as cone tracing with the same cones") {
  const Picture picture{40, 40, 256};
  const LightKind kind = GENERATE(LightKind::spot, LightKind::directional);
  const Scene scene = cornellUnder(kind);
  const Against layered = errorOf(scene, picture, pipeline("layered_reflective_shadow_maps")),
                grid = errorOf(scene, picture, pipeline("voxel_cone_tracing"));
  CAPTURE(static_cast<int>(kind), layered.rmse, layered.ratio, grid.rmse, grid.ratio);
  CHECK(layered.rmse < 1.2 * grid.rmse);
  CHECK(layered.rmse < 0.35);
  CHECK(layered.ratio == Approx(1.0).epsilon(0.06));
}

TEST_CASE("under its lamp the Cornell box errs less than by cone tracing, and more as published") {
  const Picture picture{40, 40, 256};
  const Scene scene = committed("cornell");
  const Against layered = errorOf(scene, picture, pipeline("layered_reflective_shadow_maps")),
                grid = errorOf(scene, picture, pipeline("voxel_cone_tracing")),
                published = errorOf(scene, picture, asPublished());
  CAPTURE(layered.rmse, layered.ratio, grid.rmse, published.rmse, published.ratio);
  CHECK(layered.rmse < grid.rmse);
  CHECK(layered.rmse < 0.22);
  CHECK(published.rmse > layered.rmse);
  CHECK(published.rmse < 0.4);
}

// The numbers of the card; minutes.
TEST_CASE("errors of layered maps and of cone tracing by light", "[.]") {
  KeptTable table(
      "layered_reflective_shadow_maps.errors",
      {{"cone tracing", 3, 0.02}, {"layered", 3, 0.02}, {"ratio", 2, 0.015}, {"as published", 3, 0.02}});
  const Picture picture{64, 64, 1024};
  const auto row = [&](const char* name, const Scene& scene, const std::vector<std::string>& settings) {
    const Against grid = errorOf(scene, picture, pipeline("voxel_cone_tracing"), settings),
                  layered = errorOf(scene, picture, pipeline("layered_reflective_shadow_maps"), settings),
                  published = errorOf(scene, picture, asPublished(), settings);
    table.row(name, {grid.rmse, layered.rmse, layered.ratio, published.rmse});
    CAPTURE(name, layered.rmse, published.rmse);
    CHECK(layered.rmse < 0.6);
    CHECK(layered.ratio == Approx(1.0).margin(0.1));
    CHECK(published.rmse < 0.6);
  };
  row("cornell, 64 voxels", committed("cornell"), {"resolution=64"});
  row("cornell, 128 voxels", committed("cornell"), {"resolution=128"});
  row("cornell under a spot, 64 voxels", cornellUnder(LightKind::spot), {"resolution=64"});
  row("cornell under a spot, 128 voxels", cornellUnder(LightKind::spot), {"resolution=128"});
  row("cornell under a sun, 64 voxels", cornellUnder(LightKind::directional), {"resolution=64"});
  row("arcade, 64 voxels", committed("arcade"), {"resolution=64"});
}

TEST_CASE("errors of layered maps by layers and by the share of a step", "[.]") {
  KeptTable table("layered_reflective_shadow_maps.layers",
                  {{"lamp", 3, 0.02}, {"spot", 3, 0.02}, {"sun", 3, 0.02}});
  const Picture picture{64, 64, 1024};
  const Scene lamp = committed("cornell"), spot = cornellUnder(LightKind::spot),
              sun = cornellUnder(LightKind::directional);
  const Pipeline ours = pipeline("layered_reflective_shadow_maps");
  const auto with = [&](const std::string& pass, const std::string& line) {
    std::string source = ours.document->source;
    source.insert(source.find(pass) + pass.size(), "\n    " + line + "\n");
    return Pipeline::parse(source, ours.file);
  };
  const auto row = [&](const std::string& name, const Pipeline& text,
                       const std::vector<std::string>& settings) {
    table.row(name, {errorOf(lamp, picture, text, settings).rmse, errorOf(spot, picture, text, settings).rmse,
                     errorOf(sun, picture, text, settings).rmse});
  };
  for (const char* count : {"1", "2", "4", "8"})
    row(std::string(count) + " by depth", ours, {std::string("layers=") + count});
  row("4 by depth, of as many texels", with("maps.layers {", "intervals population"), {});
  row("4 by depth, 6 by normal", with("maps.layers {", "normal_layers 6"), {});
  row("share chebyshev", with("maps.gather {", "share chebyshev"), {});
  row("slant off", with("maps.gather {", "slant off"), {});
  row("facing off", with("maps.gather {", "facing off"), {});
}
