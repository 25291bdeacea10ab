// What virtual area lights leave out, and what they survive: pictures that must stay finite and within what
// their lights can give, and inputs that must be refused.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <regex>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "support/facts.h"
#include "support/glsl_functions.h"
#include "support/virtual_area_lights.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A floor, a wall beside it and a panel before that, under a lamp without extent.
SceneBuilder floorAndPanel(float specular, float exponent) {
  SceneBuilder builder;
  const int white = builder.lambert(0.5f);
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, white);
  builder.quad({-1, 0, -1}, {2, 0, 0}, {0, 1, 0}, white);
  builder.quad({-0.5f, 0.1f, 0}, {1, 0, 0}, {0, 0.5f, 0}, builder.phong(0.3f, specular, exponent));
  builder.light(LightKind::point, glm::vec3(1.0f), {0, 0.9, 0.5});
  builder.look({0, 0.6, 2}, {0, 0.3, 0}, {0, 1, 0}, 0.8, 24, 24);
  return builder;
}
RenderOptions few(const Pipeline& text, std::vector<std::string> settings = {}) {
  settings.insert(settings.begin(), {"points=100", "lights=64"});
  RenderOptions options = sized(24, 24);
  options.parameters = text.settings(settings);
  return options;
}

bool same(const FrameResult& one, const FrameResult& other, const std::string& output) {
  return one.outputs.at(output).values() == other.outputs.at(output).values();
}

/// Of the brightest pixel; what is not finite is told by the health of the frame.
float lightest(const FrameResult& frame, const std::string& output) {
  const std::span<const float> values = frame.outputs.at(output).values();
  return *std::max_element(values.begin(), values.end());
}

}  // namespace

TEST_CASE(
    "only the eye moves: the diffuse lobe and what hides it are kept; only its look turns: so is all else") {
  const Pipeline text = pipeline("virtual_area_lights");
  const RenderOptions spheres = few(text, {"visibility=sphere"});  // by direction, `occlude` passes all
  const Scene scene = floorAndPanel(0.5f, 20.0f).scene;
  Scene moving = scene, turning = scene;
  moving.cameras.front().keys = {{0.0, {0, 0.6, 2}, {0, 0.3, 0}}, {1.0, {0.5, 0.6, 2}, {0, 0.3, 0}}};
  turning.cameras.front().keys = {{0.0, {0, 0.6, 2}, {0, 0.3, 0}}, {1.0, {0, 0.6, 2}, {0.1, 0.3, 0}}};
  for (const Scene* one : {&moving, &turning}) {
    PipelineExecutor executor(device(), techniques(), *one, text, spheres);
    CHECK(ran(executor.render(0.0, 0), "gather"));
    const FrameResult frame = executor.render(1.0, 1);
    for (const char* pass : {"points", "map", "choose"}) CHECK_FALSE(ran(frame, pass));
    for (const char* pass : {"gather", "normalise", "occlude"}) CHECK(ran(frame, pass) == (one == &moving));
    if (one == &moving)
      for (const char* part :
           {"diffuse light of points", "normalised diffuse light", "occluded diffuse light"}) {
        CAPTURE(part);
        CHECK(reused(executor, part));
      }
    PipelineExecutor alone(device(), techniques(), *one, text, spheres);
    const FrameResult afresh = alone.render(1.0);
    for (const char* output : {"indirect_diffuse", "indirect_glossy"}) CHECK(same(frame, afresh, output));
    CHECK_FALSE(same(frame, executor.render(0.0, 2), "indirect_glossy"));
  }
}

TEST_CASE("what points see is found once, however the light moves") {
  const Pipeline text = pipeline("virtual_area_lights");
  Scene scene = floorAndPanel(0.5f, 20.0f).scene;
  LightMotion motion;
  motion.keys.resize(2);
  motion.keys[0].position = glm::dvec3(0, 0.9, 0.5);
  motion.keys[1].time = 1.0;
  motion.keys[1].position = glm::dvec3(0.5, 0.9, 0.5);
  scene.lights.front().motion = motion;
  PipelineExecutor executor(device(), techniques(), scene, text, few(text));
  CHECK(ran(executor.render(0.0, 0), "look"));
  const FrameResult frame = executor.render(1.0, 1);
  CHECK(ran(frame, "gather"));
  CHECK_FALSE(ran(frame, "look"));
  PipelineExecutor alone(device(), techniques(), scene, text, few(text));
  CHECK(same(frame, alone.render(1.0), "indirect_diffuse"));
}

TEST_CASE(
    "without a light there are no points, and without a glossy material no other lobe; the same bits with all") {
  const Pipeline text = pipeline("virtual_area_lights");
  Scene dark = floorAndPanel(0.5f, 20.0f).scene, dull = floorAndPanel(0.0f, 1.0f).scene;
  dark.lights.clear();
  for (const Scene* scene : {&dark, &dull}) {
    RenderOptions options = few(text);
    PipelineExecutor executor(device(), techniques(), *scene, text, options);
    executor.keepOutput("gather", "light");
    const FrameResult frame = executor.render(0.0);
    for (const char* pass : {"points", "map", "choose", "gather", "normalise", "occlude", "apply"})
      CHECK(ran(frame, pass) == (scene == &dull));
    if (scene == &dull) {
      const SparseLight& light = kept<SparseLight>(executor, "gather", "light");
      CHECK(light.diffuse != nullptr);
      CHECK(light.glossy == nullptr);
      CHECK(light.glossyPosition == nullptr);
    }
    options.keepEverything = true;
    PipelineExecutor all(device(), techniques(), *scene, text, options);
    const FrameResult kept = all.render(0.0);
    CHECK(ran(kept, "points"));
    for (const auto& [name, image] : frame.outputs) CHECK(same(frame, kept, name));
  }
}

TEST_CASE("a frame that nothing changes runs nothing") {
  const Pipeline text = pipeline("virtual_area_lights");
  const Scene scene = floorAndPanel(0.5f, 20.0f).scene;
  PipelineExecutor executor(device(), techniques(), scene, text, few(text));
  executor.render(0.0, 0);
  for (const PassRecord& pass : executor.render(0.0, 1).passes) CHECK_FALSE(pass.ran);
}

TEST_CASE("the share of light that is clamped is told, of those points alone that have light") {
  // With an amplification of 1 all that have light lose some; backs, and what is below the lamp's reach, have
  // none.
  const std::filesystem::path file = sourceDirectory() / "scenes/pipelines/virtual_area_lights.pipeline";
  const Pipeline text = Pipeline::parse(
      std::regex_replace(readFile(file), std::regex("light gather\\.light"), "$&\namplification 1"), file);
  const Scene scene = floorAndPanel(0.5f, 200.0f).scene;
  RenderOptions options = few(text);
  options.health = true;
  const FrameResult frame = PipelineExecutor(device(), techniques(), scene, text, options).render(0.0);
  int told = 0;
  for (const std::string& note : frame.notes)
    for (const char* lobe : {"diffuse", "glossy"}) {
      double points = 0.0, lost = 0.0;
      const std::string words = std::string("pass normalise: %lf %% of the points have their ") + lobe +
                                " light clamped, %lf %% of it";
      if (std::sscanf(note.c_str(), words.c_str(), &points, &lost) != 2) continue;
      CAPTURE(note);
      CHECK(points > 1.0);
      CHECK(points < 60.0);
      CHECK(lost > 0.1);
      CHECK(lost < points);
      ++told;
    }
  CHECK(told == 2);
}

TEST_CASE(
    "exponents 0, 1 and 10^5 in one picture, and a panel that deforms to nothing: no pixel beyond its lights") {
  const Pipeline text = pipeline("virtual_area_lights");
  SceneBuilder builder = floorAndPanel(0.6f, 1e5f);
  Scene& scene = builder.scene;
  scene.objects[0].parts.front().material = builder.phong(0.3f, 0.6f, 0.0f);
  scene.objects[1].parts.front().material = builder.phong(0.3f, 0.6f, 1.0f);
  VertexSequence shrinks;
  shrinks.framesPerSecond = 1.0;
  shrinks.loop = false;
  const std::vector<glm::vec3> panel(scene.positions.end() - 4, scene.positions.end()),
      normals(scene.normals.end() - 4, scene.normals.end());
  for (const float size : {1.0f, 1e-3f, 0.0f}) {
    shrinks.positions.emplace_back();
    for (const glm::vec3& corner : panel) shrinks.positions.back().push_back(size * corner);
    shrinks.normals.push_back(normals);
  }
  scene.objects[2].sequence = shrinks;
  for (const char* settings : {"occlusion=on", "occlusion=off", "points=16", "lights=1"}) {
    RenderOptions options = few(text, {settings});
    options.health = true;
    PipelineExecutor executor(device(), techniques(), scene, text, options);
    executor.keepOutput("choose", "lights");
    for (const double time : {0.0, 0.999, 1.0, 2.0}) {
      const FrameResult frame = executor.render(time);
      CAPTURE(settings, time, frame.healthFindings);
      CHECK(frame.healthFindings.empty());
      const auto& lights = kept<SurfaceLights>(executor, "choose", "lights");
      float brightest = 0.0f;
      const std::vector<glm::vec4> values = lights.lights->downloadValues<glm::vec4>();
      for (std::size_t i = 0; i < static_cast<std::size_t>(lights.count); ++i)
        if (const float area = values[3 * i].w; area > 0.0f)
          brightest = std::max(brightest, values[3 * i + 2].x / area / static_cast<float>(kPi));
      REQUIRE(brightest > 0.0f);
      for (const auto& [output, albedo] : {std::pair("indirect_diffuse", 0.3f), {"indirect_glossy", 0.6f}}) {
        CHECK(lightest(frame, output) > 0.0f);
        CHECK(lightest(frame, output) <= 1.0001f * albedo * brightest);
      }
    }
  }
}

TEST_CASE(
    "a disc that fills all of the view is reflected as the lobe that is left of it, whatever its exponent") {
  std::vector<glm::vec4> inputs;
  for (const float exponent : {0.0f, 1.0f, 10.0f, 1e5f})
    for (const float cosine : {1.0f, 0.7f, 1e-3f}) inputs.emplace_back(exponent, cosine, 0.0f, 0.0f);
  const std::vector<glm::vec4> found =
      evaluated({"common/constants.glsl", "common/rsm.glsl", "virtual_area_lights/discs.glsl"},
                "found.xy = vec2(lobeShare(given.x, 1.0, given.y), discWidth(1.0, 1.0, 0.0));", inputs);
  for (std::size_t i = 0; i < found.size(); ++i) {
    CAPTURE(inputs[i].x, inputs[i].y, found[i].x);
    CHECK(found[i].y == 1.0f);
    CHECK(found[i].x >= 0.0f);
    CHECK(found[i].x <= 1.0f + 1e-5f);
    if (inputs[i].y == 1.0f) CHECK(found[i].x >= 0.99f);
  }
}

TEST_CASE("a number of lights or neighbours that there is no room for is refused before anything is taken") {
  const Pipeline text = pipeline("virtual_area_lights");
  const auto settingOf = [&](const std::string& setting) {
    return messageOf<Error>([&] { few(text, {setting}); });
  };
  CHECK_THAT(settingOf("neighbours=33"), Tells("neighbours", "1..32") || Tells("neighbours", 32));
  CHECK_THAT(settingOf("points=65537"), Tells("points", 65536) || Tells("points", "1..65536"));
  CHECK_THAT(settingOf("lights=0"), Tells("lights", 65536) || Tells("lights", "1..65536"));
  // A million lights, where there is room for a few.
  const Pipeline many = Pipeline::parse(R"(pipeline "many lights" {
  pass gbuffer direct_lighting.gbuffer { }
  pass map reflective_shadow_maps.render { size 16 }
  pass choose reflective_shadow_maps.choose { map map.map  lights 1048576 }
  pass sum virtual_area_lights.brute_force { gbuffer gbuffer  lights choose.lights }
  output indirect_diffuse sum.diffuse
})",
                                        "many_lights.pipeline");
  const Scene scene = floorAndPanel(0.0f, 1.0f).scene;
  gpu::Device tight({.memoryBytes = 16u << 20});
  PipelineExecutor executor(tight, techniques(), scene, many, sized(24, 24));
  CHECK_THROWS_MATCHES(executor.render(0.0), Error, Tells(1048576, "lights", "48.0 MiB"));
}
