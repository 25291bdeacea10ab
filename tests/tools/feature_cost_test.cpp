// A scene gains cost only for what it uses.
#include <algorithm>
#include <map>
#include <set>

#include "lumivox/base/log.h"
#include "lumivox/shader/library.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A room with one light, a point, and a panel of its own: nothing glossy, textured, cut out, shining,
/// moving, and nothing around it.
const std::string kPlain = R"(
scene "Plain" {
  camera main { eye 0.278 0.273 -0.8  target 0.278 0.273 0  fov 39.3 deg  resolution 24 24 }
  material matt { diffuse 0.5 0.5 0.5 }
  mesh room { file "SCENES/models/cornell.obj" }
  mesh panel { file "SCENES/models/quad.obj"  material matt  scale 0.1  translate 0.3 0.2 0.1 }
  light bulb point { position 0.278 0.5 0.278  intensity 1 1 1 }
}
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  REQUIRE(place != std::string::npos);
  return text.replace(place, from.size(), to);
}
std::string added(const std::string& line) {
  return with(kPlain, "  light bulb", "  " + line + "\n  light bulb");
}

Scene sceneOf(std::string text) {
  const TemporaryDirectory directory;
  for (std::size_t place; (place = text.find("SCENES")) != std::string::npos;)
    text.replace(place, 6, (sourceDirectory() / "scenes").string());
  return loadScene(directory.write("made.scene", text));
}

/// The work of a pipeline on a scene, in short words: "pass gather" runs in the first frame, "again gather"
/// in the one after it, "program voxel_cone_tracing/gather" is needed, with "gather GLOSSY=1" among its axes.
struct Cost {
  std::set<std::string> words;
  std::map<std::string, std::uint64_t> bytes;  ///< per pass
};

void addVariants(PipelineExecutor& executor, Cost& cost) {
  for (const auto& [name, usage] : executor.shaders().usage()) {
    if (usage.needed.empty()) continue;
    const std::size_t slash = name.find('/');
    const std::string programName = name.substr(slash + 1);
    // The same voxelizer, by whichever way this device is faster. Whatever technique runs a program of the
    // toolkit.
    const std::string stem = programName == "conservative_compute"     ? "conservative"
                             : name.substr(0, slash + 1) == "toolkit/" ? name
                                                                       : programName;
    const shader::PackedProgram& program =
        executor.shaders().packs().at(name.substr(0, slash)).program(programName);
    cost.words.insert("program " + stem);
    for (const std::vector<int>& needed : usage.needed)
      for (std::size_t axis = 0; axis < needed.size(); ++axis)
        cost.words.insert(stem + " " + program.axes[axis].name + "=" + program.axes[axis].text(needed[axis]));
  }
}

Cost costOf(const std::string& sceneText, const Pipeline& text) {
  const LogCapture silent;  // the grids are coarser than anybody would take them
  RenderOptions options;
  const std::map<std::string, double> small{
      {"resolution", 16},       {"area_samples", 4}, {"surfaces", 16}, {"iterations", 8}, {"samples", 25},
      {"smoke_resolution", 16}, {"elements", 64},    {"bins", 4},      {"points", 64},    {"lights", 32}};
  for (const PipelineParameter& parameter : text.parameters)
    if (const auto value = small.find(parameter.name); value != small.end())
      options.parameters[parameter.name].number = value->second;
  const Scene scene = sceneOf(sceneText);
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  Cost cost;
  for (const PassRecord& pass : executor.render(0.0, 0, PipelineExecutor::Images::no).passes) {
    if (pass.ran) cost.words.insert("pass " + pass.name);
    cost.bytes[pass.name] = pass.bytes;
  }
  for (const PassRecord& pass : executor.render(1.0 / 24, 1, PipelineExecutor::Images::no).passes)
    if (pass.ran) cost.words.insert("again " + pass.name);
  addVariants(executor, cost);
  return cost;
}

/// The extra cost of the second scene; axes of new programs are not repeated.
std::set<std::string> gained(const Cost& before, const Cost& after) {
  std::set<std::string> words;
  std::set_difference(after.words.begin(), after.words.end(), before.words.begin(), before.words.end(),
                      std::inserter(words, words.end()));
  for (auto word = words.begin(); word != words.end();) {
    const std::string program = "program " + word->substr(0, word->find(' '));
    const bool ofNew = word->find('=') != std::string::npos && words.count(program) != 0;
    word = ofNew ? words.erase(word) : std::next(word);
  }
  for (const auto& [pass, bytes] : after.bytes)
    if (before.bytes.count(pass) != 0 && before.bytes.at(pass) < bytes) words.insert("bytes " + pass);
  return words;
}

std::string matt(const std::string& properties) {
  return with(kPlain, "diffuse 0.5 0.5 0.5", properties);
}

/// One thing more than the plain scene has.
const std::map<std::string, std::string>& features() {
  static const std::map<std::string, std::string> all{
      {"glossy material", matt("diffuse 0.5 0.5 0.5  specular 0.2 0.2 0.2  exponent 30")},
      {"texture", matt("diffuse 1 1 1  texture \"SCENES/models/textures/tiles.png\"")},
      {"cut-out mask", matt("diffuse 0.5 0.5 0.5  mask \"SCENES/models/textures/leaves_mask.png\"")},
      {"environment", added("environment { radiance 0.1 0.1 0.1 }")},
      {"even medium", added("medium fog { extinction 0.5 /m  albedo 0.5 }")},
      {"particles",
       added("medium smoke { particles 100  source 0.28 0.1 0.28  spread 5 cm  radius 4 cm  rise 0.1 m/s  "
             "drift 0.02 m/s  life 2 s  albedo 0.9  extinction 20 /m }")},
      {"emission", added("light lamp area { mesh room/ceiling_lamp  radiance 5 5 5 }")},
      {"moving object", added("animate panel { rotate 0 1 0  45 deg/s }")},
      {"moving camera",
       with(kPlain, "resolution 24 24",
            "resolution 24 24\n    key { time 0 s  eye 0.278 0.273 -0.8  target 0.278 0.273 0 }\n"
            "    key { time 2 s  eye 0.3 0.273 -0.8  target 0.278 0.273 0 }")},
      {"sun", added("light sun directional { direction 0.1 -1 0.2  irradiance 3 3 3 }")},
      {"spot", added("light beam spot { position 0.3 0.5 0.3  direction 0 -1 0.1  intensity 1 1 1  "
                     "inner 10 deg  outer 20 deg }")}};
  return all;
}

using Expected = std::map<std::string, std::set<std::string>>;

/// Checks every feature; those that are not expected to cost anything must not.
void checkCosts(const std::string& pipelineName, const Expected& expected) {
  const Pipeline text = pipeline(pipelineName);
  const Cost plain = costOf(kPlain, text);
  for (const auto& [feature, scene] : features()) {
    const auto wanted = expected.find(feature);
    INFO(pipelineName << ", " << feature);
    const Cost cost = costOf(scene, text);
    CHECK(gained(plain, cost) == (wanted == expected.end() ? std::set<std::string>{} : wanted->second));
    // Nothing that ran before is missing: the features are additions.
    for (const std::string& word : plain.words)
      if (word.rfind("pass ", 0) == 0) CHECK(cost.words.count(word) == 1);
  }
}

}  // namespace

TEST_CASE("a scene pays for what it uses and nothing else: direct light") {
  checkCosts("direct_lighting",
             {
                 {"cut-out mask", {"gbuffer MASKS=1", "shadow_map MASKS=1"}},
                 {"emission", {"bytes gbuffer", "bytes shadow", "gbuffer EMISSION=1", "shade EMISSION=1"}},
                 {"glossy material", {"bytes gbuffer", "gbuffer GLOSSY=1", "shade GLOSSY=1"}},
                 {"moving camera", {"again direct", "again gbuffer"}},
                 {"moving object", {"again direct", "again gbuffer", "again shadow"}},
                 {"spot", {"bytes shadow"}},
                 {"sun", {"bytes shadow"}},
                 {"texture", {"gbuffer TEXTURES=1"}},
             });
}

TEST_CASE("a scene pays for what it uses and nothing else: cones in voxels") {
  checkCosts("voxel_cone_tracing",
             {
                 {"cut-out mask", {"conservative MASKS=1", "gbuffer MASKS=1", "shadow_map MASKS=1"}},
                 {"emission", {"bytes gbuffer", "bytes shadow", "gbuffer EMISSION=1", "shade EMISSION=1"}},
                 {"environment", {"gather ENVIRONMENT=1"}},
                 {"glossy material",
                  {"bytes gather", "bytes gbuffer", "compose GLOSSY=1", "gather GLOSSY=1", "gbuffer GLOSSY=1",
                   "shade GLOSSY=1"}},
                 {"moving camera", {"again compose", "again direct", "again gather", "again gbuffer"}},
                 {"moving object",
                  {"add CHANGED=1",
                   "again compose",
                   "again direct",
                   "again gather",
                   "again gbuffer",
                   "again grid",
                   "again light",
                   "again shadow",
                   "again voxels",
                   "bytes light",
                   "bytes voxels",
                   "claim CHANGED=1",
                   "inject CHANGED=1",
                   "mark CHANGED=1",
                   "program changed_bricks",
                   "program toolkit/changed_lit",
                   "program toolkit/changed_join",
                   "program toolkit/changed_list",
                   "program toolkit/changed_mark",
                   "program toolkit/scan",
                   "program toolkit/changed_sort",
                   "program toolkit/changed_views",
                   "program count_behind",
                   "resolve CHANGED=1"}},
                 {"spot", {"bytes shadow"}},
                 {"sun", {"bytes shadow"}},
                 {"texture", {"conservative TEXTURES=1", "gbuffer TEXTURES=1"}},
             });
}

TEST_CASE("a scene pays for what it uses and nothing else: light propagated from shadow maps") {
  checkCosts(
      "light_propagation_volumes",
      {
          {"cut-out mask",
           {"conservative MASKS=1", "gbuffer MASKS=1", "render MASKS=1", "shadow_map MASKS=1"}},
          {"emission",
           {"bytes gbuffer", "bytes lights", "bytes shadow", "gbuffer EMISSION=1", "shade EMISSION=1"}},
          {"environment", {"start OUTSIDE=environment"}},
          {"glossy material",
           {"bytes gbuffer",
            "compose GLOSSY=1",
            "gather DIFFUSE=0",
            "gather ENVIRONMENT=0",
            "gather GLOSSY=1",
            "gather LOBES=0",
            "gather FACES=one",
            "gather LOOK_UP=own",
            "gather MEDIUM=none",
            "gather STORE=dense",
            "gbuffer GLOSSY=1",
            "pass average",
            "pass cones",
            "pass grid",
            "pass reflect",
            "program average_add",
            "program toolkit/claim",
            "program toolkit/number",
            "program average_resolve",
            "program filter",
            "program reflect",
            "shade GLOSSY=1"}},
          {"moving camera", {"again compose", "again direct", "again gather", "again gbuffer"}},
          {"moving object",
           {"again compose", "again direct", "again gather", "again gbuffer", "again inject", "again lights",
            "again propagate", "again shadow", "again voxels", "bytes voxels", "program count_behind"}},
          {"spot", {"bytes lights", "bytes shadow"}},
          {"sun", {"bytes lights", "bytes shadow"}},
          {"texture", {"conservative TEXTURES=1", "gbuffer TEXTURES=1", "render TEXTURES=1"}},
      });
}

TEST_CASE("a scene pays for what it uses and nothing else: light propagated from voxels") {
  checkCosts(
      "light_propagation_volumes_voxels",
      {
          {"cut-out mask", {"conservative MASKS=1", "gbuffer MASKS=1", "shadow_map MASKS=1"}},
          {"emission", {"bytes gbuffer", "bytes shadow", "gbuffer EMISSION=1", "shade EMISSION=1"}},
          {"environment", {"start OUTSIDE=environment"}},
          {"glossy material", {"bytes gbuffer", "gbuffer GLOSSY=1", "shade GLOSSY=1"}},
          {"moving camera", {"again compose", "again direct", "again gather", "again gbuffer"}},
          {"moving object",
           {"again compose", "again direct", "again gather", "again gbuffer", "again inject",
            "again propagate", "again shadow", "again voxels", "bytes voxels", "program count_behind"}},
          {"spot", {"bytes shadow"}},
          {"sun", {"bytes shadow"}},
          {"texture", {"conservative TEXTURES=1", "gbuffer TEXTURES=1"}},
      });
}

TEST_CASE("a scene pays for what it uses and nothing else: reflective shadow maps") {
  checkCosts("reflective_shadow_maps",
             {
                 {"cut-out mask", {"gbuffer MASKS=1", "render MASKS=1", "shadow_map MASKS=1"}},
                 {"emission",
                  {"bytes choose", "bytes gbuffer", "bytes lights", "bytes shadow", "gbuffer EMISSION=1",
                   "shade EMISSION=1"}},
                 {"glossy material", {"bytes gbuffer", "gbuffer GLOSSY=1", "shade GLOSSY=1"}},
                 {"moving camera", {"again compose", "again direct", "again gather", "again gbuffer"}},
                 {"moving object",
                  {"again choose", "again compose", "again direct", "again gather", "again gbuffer",
                   "again lights", "again shadow"}},
                 {"spot", {"bytes choose", "bytes lights", "bytes shadow"}},
                 {"sun", {"bytes choose", "bytes lights", "bytes shadow"}},
                 {"texture", {"gbuffer TEXTURES=1", "render TEXTURES=1"}},
             });
}

TEST_CASE("a scene pays for what it uses and nothing else: near-field voxels") {
  checkCosts(
      "near_field_voxels",
      {
          {"cut-out mask",
           {"conservative MASKS=1", "gbuffer MASKS=1", "render MASKS=1", "shadow_map MASKS=1"}},
          {"emission",
           {"bytes gbuffer", "bytes lights", "bytes shadow", "gbuffer EMISSION=1", "shade EMISSION=1"}},
          {"glossy material", {"bytes gbuffer", "gbuffer GLOSSY=1", "shade GLOSSY=1"}},
          {"moving camera",
           {"again compose", "again direct", "again gather", "again gbuffer", "again smooth"}},
          {"moving object",
           {"again bits", "again compose", "again direct", "again gather", "again gbuffer", "again lights",
            "again shadow", "again smooth", "again voxels", "bytes voxels", "program count_behind",
            "bits_mark MOVING=1", "bits_mip TOUCHED=1", "bits_stack TOUCHED=1", "bytes bits",
            "program bits_copy", "program bits_restore"}},
          {"spot", {"bytes lights", "bytes shadow"}},
          {"sun", {"bytes lights", "bytes shadow"}},
          {"texture", {"conservative TEXTURES=1", "gbuffer TEXTURES=1", "render TEXTURES=1"}},
      });
}

TEST_CASE("a scene pays for what it uses and nothing else: screen space") {
  checkCosts(
      "screen_space",
      {
          {"cut-out mask", {"gbuffer MASKS=1", "shadow_map MASKS=1"}},
          {"emission",
           {"bytes gbuffer", "bytes shadow", "gbuffer EMISSION=1", "shade EMISSION=1", "ssdo EMISSION=1"}},
          {"glossy material", {"bytes gbuffer", "gbuffer GLOSSY=1", "shade GLOSSY=1"}},
          {"moving camera",
           {"again bounce", "again compose", "again direct", "again gbuffer", "again occlusion",
            "again smooth"}},
          {"moving object",
           {"again bounce", "again compose", "again direct", "again gbuffer", "again occlusion",
            "again shadow", "again smooth"}},
          {"spot", {"bytes shadow"}},
          {"sun", {"bytes shadow"}},
          {"texture", {"gbuffer TEXTURES=1"}},
      });
}

TEST_CASE("a scene pays for what it uses and nothing else: smoke") {
  checkCosts("volumetric_smoke",
             {
                 {"cut-out mask", {"conservative MASKS=1", "gbuffer MASKS=1", "shadow_map MASKS=1"}},
                 {"emission", {"bytes gbuffer", "bytes shadow", "gbuffer EMISSION=1", "shade EMISSION=1"}},
                 {"environment", {"gather ENVIRONMENT=1"}},
                 {"even medium",
                  {"bytes direct", "bytes gather", "bytes light", "compose SCATTERED=1",
                   "compose TRANSMITTANCE=1", "gather MEDIUM=even", "inject MEDIUM=even", "pass march",
                   "pass smoke", "pass smooth", "program march", "program upsample", "shade MEDIUM=even"}},
                 {"glossy material",
                  {"bytes gather", "bytes gbuffer", "compose GLOSSY=1", "gather GLOSSY=1", "gbuffer GLOSSY=1",
                   "shade GLOSSY=1"}},
                 {"moving camera", {"again compose", "again direct", "again gather", "again gbuffer"}},
                 {"moving object",
                  {"add CHANGED=1",
                   "again compose",
                   "again direct",
                   "again gather",
                   "again gbuffer",
                   "again grid",
                   "again light",
                   "again shadow",
                   "again voxels",
                   "bytes light",
                   "bytes voxels",
                   "claim CHANGED=1",
                   "claim DIRECTIONS=1",
                   "inject CHANGED=1",
                   "mark CHANGED=1",
                   "program changed_bricks",
                   "program toolkit/changed_lit",
                   "program toolkit/changed_join",
                   "program toolkit/changed_list",
                   "program toolkit/changed_mark",
                   "program toolkit/scan",
                   "program toolkit/changed_sort",
                   "program toolkit/changed_views",
                   "program count_behind",
                   "resolve CHANGED=1"}},
                 {"particles",
                  {"again compose",
                   "again direct",
                   "again gather",
                   "again grid",
                   "again light",
                   "again march",
                   "again particles",
                   "again smoke",
                   "again smooth",
                   "bytes direct",
                   "bytes gather",
                   "bytes light",
                   "compose SCATTERED=1",
                   "compose TRANSMITTANCE=1",
                   "gather MEDIUM=varying",
                   "inject MEDIUM=varying",
                   "pass march",
                   "pass particles",
                   "pass smoke",
                   "pass smooth",
                   "pass solid",
                   "program average_add",
                   "program toolkit/claim",
                   "program toolkit/number",
                   "program average_resolve",
                   "program density",
                   "program insert",
                   "program light_depth",
                   "program march",
                   "program particles",
                   "program upsample",
                   "shade MEDIUM=varying"}},
                 {"spot", {"bytes shadow"}},
                 {"sun", {"bytes shadow"}},
                 {"texture", {"conservative TEXTURES=1", "gbuffer TEXTURES=1"}},
             });
}

TEST_CASE("a scene pays for what it uses and nothing else: light between surface elements") {
  checkCosts("implicit_visibility",
             {
                 {"cut-out mask", {"gbuffer MASKS=1", "shadow_map MASKS=1"}},
                 {"emission",
                  {"bytes elements", "bytes gbuffer", "bytes links", "bytes shadow", "gbuffer EMISSION=1",
                   "shade EMISSION=1"}},
                 {"environment", {"illuminate ENVIRONMENT=1"}},
                 {"glossy material",
                  {"bytes display", "bytes elements", "bytes gbuffer", "bytes illuminate", "compose GLOSSY=1",
                   "gbuffer GLOSSY=1", "illuminate OUTGOING=1", "program display_glossy",
                   "program pull_up_outgoing", "program reflect_glossy", "shade GLOSSY=1"}},
                 {"moving camera", {"again compose", "again direct", "again display", "again gbuffer"}},
                 {"moving object",
                  {"again compose", "again direct", "again display", "again elements", "again gbuffer",
                   "again illuminate", "again links", "again pairs", "again shadow", "bytes elements"}},
                 {"spot", {"bytes shadow"}},
                 {"sun", {"bytes shadow"}},
                 {"texture", {"gbuffer TEXTURES=1"}},
             });
}

TEST_CASE("a scene pays for what it uses and nothing else: light between surface elements, all by links") {
  checkCosts("implicit_visibility_lights",
             {
                 {"cut-out mask", {"gbuffer MASKS=1", "shadow_map MASKS=1"}},
                 {"emission",
                  {"bytes display", "bytes elements", "bytes gbuffer", "bytes illuminate", "bytes links",
                   "bytes shadow", "display ADDED=1", "gbuffer EMISSION=1", "illuminate LISTED=1",
                   "light_leaves LIGHTS=0", "light_leaves LINKED=1", "light_leaves OF=emitted",
                   "light_leaves SHADOWS=0", "pull_up SUMS=0", "shade EMISSION=1"}},
                 {"environment", {"illuminate ENVIRONMENT=1"}},
                 {"glossy material",
                  {"bytes display", "bytes elements", "bytes gbuffer", "bytes illuminate", "compose GLOSSY=1",
                   "gbuffer GLOSSY=1", "illuminate OUTGOING=1", "program display_glossy",
                   "program pull_up_outgoing", "program reflect_glossy", "shade GLOSSY=1"}},
                 {"moving camera", {"again compose", "again display", "again gbuffer", "again shade"}},
                 {"moving object",
                  {"again compose", "again display", "again elements", "again gbuffer", "again illuminate",
                   "again links", "again pairs", "again shade", "again shadow", "bytes elements"}},
                 {"spot", {"bytes shadow"}},
                 {"sun", {"bytes shadow"}},
                 {"texture", {"gbuffer TEXTURES=1"}},
             });
}

TEST_CASE("a scene pays for what it uses and nothing else: light averaged at surface points") {
  checkCosts(
      "virtual_area_lights",
      {
          {"cut-out mask", {"gbuffer MASKS=1", "render MASKS=1", "shadow_map MASKS=1"}},
          {"emission",
           {"bytes choose", "bytes gbuffer", "bytes map", "bytes shadow", "gbuffer EMISSION=1",
            "shade EMISSION=1"}},
          {"glossy material",
           {"apply GLOSSY=1", "bytes apply", "bytes gather", "bytes gbuffer", "bytes normalise",
            "bytes occlude", "compose GLOSSY=1", "gather LOBE=glossy", "gbuffer GLOSSY=1",
            "normalise LOBE=glossy", "shade GLOSSY=1"}},
          {"moving camera", {"again apply", "again compose", "again direct", "again gbuffer"}},
          {"moving object",
           {"again apply", "again choose", "again compose", "again direct", "again gather", "again gbuffer",
            "again map", "again normalise", "again occlude", "again points", "again shadow"}},
          {"spot", {"bytes choose", "bytes map", "bytes shadow"}},
          {"sun", {"bytes choose", "bytes map", "bytes shadow"}},
          {"texture", {"gbuffer TEXTURES=1", "render TEXTURES=1"}},
      });
}
