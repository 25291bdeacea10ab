// A scene gains cost only for what it uses.
#include <algorithm>
#include <map>
#include <set>
#include <sstream>

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

/// What features cost beyond direct light, in words as `Cost` has them that share their first one:
/// "again compose gather; gather GLOSSY=1 MEDIUM=even"; "not" before what direct light costs elsewhere.
using Expected = std::map<std::string, std::string>;

std::set<std::string> wordsOf(const std::string& text, std::set<std::string> words) {
  std::istringstream groups(text);
  for (std::string group; std::getline(groups, group, ';');) {
    std::istringstream all(group);
    std::string first, word;
    all >> first;
    const bool without = first == "not";
    if (without) all >> first;
    while (all >> word)
      if (without)
        words.erase(first + " " + word);
      else
        words.insert(first + " " + word);
  }
  return words;
}

/// Every pipeline shows direct light, and pays for it.
const Expected kDirect{{"cut-out mask", "gbuffer MASKS=1; shadow_map MASKS=1"},
                       {"emission", "bytes gbuffer shadow; gbuffer EMISSION=1; shade EMISSION=1"},
                       {"glossy material", "bytes gbuffer; gbuffer GLOSSY=1; shade GLOSSY=1"},
                       {"moving camera", "again direct gbuffer"},
                       {"moving object", "again direct gbuffer shadow"},
                       {"spot", "bytes shadow"},
                       {"sun", "bytes shadow"},
                       {"texture", "gbuffer TEXTURES=1"}};

struct PipelineCosts {
  const char* pipeline;
  Expected beyond;
};
const std::vector<PipelineCosts> kPipelines{
    {"direct_lighting", {}},
    {"voxel_cone_tracing",
     {{"cut-out mask", "conservative MASKS=1"},
      {"environment", "gather ENVIRONMENT=1"},
      {"glossy material", "bytes gather; compose GLOSSY=1; gather GLOSSY=1"},
      {"moving camera", "again compose gather"},
      {"moving object",
       "again compose gather grid light voxels; program changed_bricks toolkit/scan "
       "toolkit/changed_lit toolkit/changed_join toolkit/changed_list toolkit/changed_mark "
       "toolkit/changed_sort toolkit/changed_views "
       "count_behind; bytes light voxels; add CHANGED=1; claim CHANGED=1; inject CHANGED=1; mark "
       "CHANGED=1; resolve CHANGED=1"},
      {"texture", "conservative TEXTURES=1"}}},
    {"light_propagation_volumes",
     {{"cut-out mask", "conservative MASKS=1; render MASKS=1"},
      {"emission", "bytes lights"},
      {"environment", "start OUTSIDE=environment"},
      {"glossy material",
       "pass average cones grid reflect; program average_add toolkit/claim toolkit/number "
       "average_resolve filter reflect; compose GLOSSY=1; gather DIFFUSE=0 ENVIRONMENT=0 FACES=one "
       "GLOSSY=1 LOBES=0 MEDIUM=none STORE=dense; render LOBES=1"},
      {"moving camera", "again compose gather"},
      {"moving object",
       "again compose gather inject lights propagate voxels; program count_behind; bytes voxels"},
      {"spot", "bytes lights"},
      {"sun", "bytes lights"},
      {"texture", "conservative TEXTURES=1; render TEXTURES=1"}}},
    {"light_propagation_volumes_voxels",
     {{"cut-out mask", "conservative MASKS=1"},
      {"environment", "start OUTSIDE=environment"},
      {"moving camera", "again compose gather"},
      {"moving object", "again compose gather inject propagate voxels; program count_behind; bytes voxels"},
      {"texture", "conservative TEXTURES=1"}}},
    {"reflective_shadow_maps",
     {{"cut-out mask", "render MASKS=1"},
      {"emission", "bytes choose lights"},
      {"glossy material", "bytes lights; choose GLOSSY=1; gather GLOSSY=1; render GLOSSY=1 LOBES=1"},
      {"moving camera", "again compose gather"},
      {"moving object", "again choose compose gather lights"},
      {"spot", "bytes choose lights"},
      {"sun", "bytes choose lights"},
      {"texture", "render TEXTURES=1"}}},
    {"near_field_voxels",
     {{"cut-out mask", "conservative MASKS=1; render MASKS=1"},
      {"emission", "bytes lights"},
      {"glossy material", "render LOBES=1"},
      {"moving camera", "again compose gather smooth"},
      {"moving object",
       "again bits compose gather lights smooth voxels; program bits_copy bits_restore count_behind; "
       "bytes bits voxels; bits_mark MOVING=1; bits_mip TOUCHED=1; bits_stack TOUCHED=1"},
      {"spot", "bytes lights"},
      {"sun", "bytes lights"},
      {"texture", "conservative TEXTURES=1; render TEXTURES=1"}}},
    {"voxel_path_tracing",
     {{"cut-out mask", "conservative MASKS=1; render MASKS=1"},
      {"emission",
       "bytes average lights; program average_brightest; average_add EMISSION=1; average_resolve EMISSION=1"},
      {"glossy material",
       "bytes lights trace; compose GLOSSY=1; finish REFLECTED=1; render GLOSSY=1; trace GLOSSY=1 REFLECTED=1"},
      {"moving camera", "again compose smooth trace"},
      {"moving object",
       "again average compose lights smooth trace voxels; program bits_copy bits_restore count_behind; "
       "bytes average voxels; bits_mark MOVING=1; bits_mip TOUCHED=1; bits_stack TOUCHED=1"},
      {"spot", "bytes lights"},
      {"sun", "bytes lights"},
      {"texture", "conservative TEXTURES=1; render TEXTURES=1"}}},
    {"screen_space",
     {{"emission", "ssdo EMISSION=1"},
      {"moving camera", "again bounce compose occlusion smooth"},
      {"moving object", "again bounce compose occlusion smooth"}}},
    {"volumetric_smoke",
     {{"cut-out mask", "conservative MASKS=1"},
      {"environment", "gather ENVIRONMENT=1"},
      {"even medium",
       "pass march smoke smooth; program march upsample; bytes direct gather light; compose "
       "SCATTERED=1 TRANSMITTANCE=1; gather MEDIUM=even; inject MEDIUM=even; shade MEDIUM=even"},
      {"glossy material", "bytes gather; compose GLOSSY=1; gather GLOSSY=1"},
      {"moving camera", "again compose gather"},
      {"moving object",
       "again compose gather grid light voxels; program changed_bricks toolkit/scan "
       "toolkit/changed_lit toolkit/changed_join toolkit/changed_list toolkit/changed_mark "
       "toolkit/changed_sort toolkit/changed_views "
       "count_behind; bytes light voxels; add CHANGED=1; claim CHANGED=1 DIRECTIONS=1; inject "
       "CHANGED=1; mark CHANGED=1; resolve CHANGED=1"},
      {"particles",
       "pass march particles smoke smooth solid; again compose direct gather grid light march "
       "particles smoke smooth; program average_add toolkit/claim toolkit/number average_resolve "
       "density insert light_depth march particles upsample; bytes direct gather light; compose "
       "SCATTERED=1 TRANSMITTANCE=1; gather MEDIUM=varying; inject MEDIUM=varying; shade "
       "MEDIUM=varying"},
      {"texture", "conservative TEXTURES=1"}}},
    {"implicit_visibility",
     {{"emission", "bytes elements links"},
      {"environment", "illuminate ENVIRONMENT=1"},
      {"glossy material",
       "program display_glossy pull_up_outgoing reflect_glossy; bytes display elements illuminate; "
       "compose GLOSSY=1; illuminate OUTGOING=1"},
      {"moving camera", "again compose display"},
      {"moving object", "again compose display elements illuminate links pairs; bytes elements"}}},
    {"implicit_visibility_lights",
     {{"emission",
       "bytes display elements illuminate links; display ADDED=1; illuminate LISTED=1; light_leaves "
       "LIGHTS=0 LINKED=1 OF=emitted SHADOWS=0; pull_up SUMS=0"},
      {"environment", "illuminate ENVIRONMENT=1"},
      {"glossy material",
       "program display_glossy pull_up_outgoing reflect_glossy; bytes display elements illuminate; "
       "compose GLOSSY=1; illuminate OUTGOING=1"},
      {"moving camera", "again compose display shade; not again direct"},
      {"moving object",
       "again compose display elements illuminate links pairs shade; bytes elements; not again "
       "direct"}}},
    {"virtual_area_lights",
     {{"cut-out mask", "render MASKS=1"},
      {"emission", "bytes choose map"},
      {"glossy material",
       "bytes apply gather map normalise; apply GLOSSY=1; choose GLOSSY=1; compose GLOSSY=1; gather "
       "LOBE=glossy LOBED=1; normalise LOBE=glossy; render GLOSSY=1 LOBES=1"},
      {"moving camera", "again apply compose"},
      {"moving object", "again apply choose compose gather look map normalise occlude points"},
      {"spot", "bytes choose map"},
      {"sun", "bytes choose map"},
      {"texture", "render TEXTURES=1"}}}};

}  // namespace

TEST_CASE("a scene pays for what it uses and nothing else, in every pipeline") {
  const PipelineCosts costs = GENERATE(from_range(kPipelines));
  const Pipeline text = pipeline(costs.pipeline);
  const Cost plain = costOf(kPlain, text);
  const auto ofFeature = [](const Expected& all, const std::string& feature) {
    const auto found = all.find(feature);
    return found == all.end() ? std::string() : found->second;
  };
  for (const auto& [feature, scene] : features()) {
    INFO(costs.pipeline << ", " << feature);
    const Cost cost = costOf(scene, text);
    CHECK(gained(plain, cost) ==
          wordsOf(ofFeature(costs.beyond, feature), wordsOf(ofFeature(kDirect, feature), {})));
    // Nothing that ran before is missing: the features are additions.
    for (const std::string& word : plain.words)
      if (word.rfind("pass ", 0) == 0) CHECK(cost.words.count(word) == 1);
  }
}
