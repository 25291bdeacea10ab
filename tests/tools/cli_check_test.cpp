// check on real files: what it finds, that one mistake gives one finding, and that messages say what is
// wrong.
#include <algorithm>

#include "lumivox/base/file.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr const char* kPipeline =
    "pipeline \"Cones\" {\n"
    "  param resolution 32 in 1..512\n"
    "  pass gbuffer direct_lighting.gbuffer { }\n"
    "  pass shadow direct_lighting.shadow_map { }\n"
    "  pass direct direct_lighting.shade {\n"
    "    gbuffer gbuffer\n"
    "    shadow shadow.depth\n"
    "  }\n"
    "  pass voxels voxelization.conservative { resolution $resolution }\n"
    "  pass light voxel_cone_tracing.inject {\n"
    "    fragments voxels.fragments\n"
    "    shadow shadow.depth\n"
    "  }\n"
    "  pass grid voxel_cone_tracing.filter { radiance light.radiance }\n"
    "  pass cones voxel_cone_tracing.gather {\n"
    "    gbuffer gbuffer\n"
    "    grid grid.mips\n"
    "    cones 6\n"
    "  }\n"
    "  pass compose direct_lighting.compose {\n"
    "    direct direct.radiance\n"
    "    diffuse cones.diffuse\n"
    "    glossy cones.glossy\n"
    "  }\n"
    "  output final compose.radiance\n"
    "}\n"
    "\n"
    "sweep quality {\n"
    "  resolution [16 32 64]\n"
    "}\n";
constexpr const char* kLight = "light bulb point { position 0.2 0.5 0  intensity 1 1 1 }";

std::string replaced(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  INFO(part);
  REQUIRE(at != std::string::npos);
  return text.replace(at, part.size(), by);
}

struct Checked {
  CommandResult result;
  nlohmann::json findings;
  std::string text;  ///< of the messages alone
};

Checked checked(const Workplace& place, const std::string& name, const std::string& options = "") {
  Checked all;
  all.result = runCommand("lumivox check --json " + options + " '" + place.file(name) + "'");
  INFO(all.result.output << all.result.errors);
  const auto json = nlohmann::json::parse(all.result.output);
  REQUIRE(json.size() == 1);
  all.findings = json[0]["findings"];
  for (const auto& finding : all.findings)
    all.text += finding.value("severity", "") + " " + std::to_string(finding.value("line", 0)) + ": " +
                finding.value("what", "") + "; expected " + finding.value("expected", "") +
                "; did you mean " + finding.value("suggestion", "") + "\n";
  return all;
}

/// A slip in one of the good texts, and what its only finding says.
struct Slip {
  const char* part;
  const char* by;
  int line;
  const char* says;
};

void checkSlips(const std::string& good, const std::string& name, const std::vector<Slip>& slips) {
  const Workplace place;
  for (const Slip& slip : slips) {
    place.write(name, replaced(good, slip.part, slip.by));
    const Checked one = checked(place, name);
    INFO(slip.part << " -> " << slip.by << "\n" << one.text);
    CHECK(one.result.exitCode == 2);
    CHECK(one.findings.size() == 1);
    if (one.findings.empty()) continue;
    CHECK(one.findings[0].value("line", 0) == slip.line);
    CHECK(contains(one.text, slip.says));
    CHECK_FALSE(contains(one.text, "measures no unit"));
  }
}

}  // namespace

TEST_CASE("one mistake in a scene gives one finding, at its line") {
  checkSlips(
      kRoomScene, "slip.scene",
      {{kLight, "light accent spotlight { position 0 0 0  direction 0 -1 0  intensity 1 }", 4,
        "unknown kind 'spotlight' of block 'light'; expected one of area, directional, point, spot; did you mean spot"},
       {kLight, "light bulb { position 0.2 0.5 0  intensity 1 1 1 }", 4, "block 'light bulb' lacks its kind"},
       {kLight, "light point main { position 0.2 0.5 0  intensity 1 1 1 }", 4,
        "did you mean light main point"},
       {"\"room.obj\"", "\"room.obj", 3, "the string is not closed"},
       {"file \"room.obj\"", "file room.obj\"", 3, "the string is not closed"},
       {"scene \"Little room\"", "scene \"Little room", 1, "the string is not closed"},
       {"{ file \"room.obj\" }", "{ file \"room.obj\" use { part walls  material white } }", 3,
        "a line break is missing before 'use'"},
       {"eye 0 0 0.9", "eye 0, 0, 0.9", 2, "unexpected ','"},
       {"eye 0 0 0.9", "eye (0 0 0.9)", 2, "without parentheses"},
       {"intensity 1 1 1", "intensity 0,5", 4, "'.' in a decimal number"},
       {"fov 70 deg", "fov 70 degrees", 2,
        "unknown unit 'degrees'; expected an angle such as 39 deg; did you mean deg"},
       {"fov 70 deg", "fov = 70 deg", 2, "unexpected '='"},
       {"fov 70 deg", "fov 70", 2, "has no unit"},
       {"resolution 24 16", "resolution 24x16", 2, "with a blank between, as in 24 16"},
       {"resolution 24 16", "resolution 24 x 16", 2, "property 'resolution' has 1 value"},
       {"\"room.obj\"", "'room.obj'", 3, "a string in single quotes; expected \"room.obj\""},
       {"  light", "  // the lamp\n  light", 4, "unexpected '//'; expected '#' before a comment"},
       {"  light", "  /* the\n  lamp */\n  light", 4, "unexpected '/*'"},
       {"camera main { eye", "camera main eye", 2, "this '}' ends block 'scene \"Little room\"' of line 1"},
       {"intensity 1 1 1 }", "intensity 1 1 1 } }", 4, "or one '}' less"},
       {"intensity 1 1 1 }", "intensity 1 1 1", 4, "by its indentation, 'light bulb point' lacks one"},
       {"file \"room.obj\" }", "file \"room.obj\"", 3, "by its indentation, 'mesh room' lacks one"},
       {"scene \"Little room\" {", "", 2, "'camera' stands outside of a block 'scene'"},
       {"scene \"Little room\"", "scene Little room", 1, "\"Little room\" in double quotes"},
       {"camera main", "camra main", 2, "did you mean camera"},
       {"camera main", "Camera main", 2, "did you mean camera"},
       {"mesh room", "mash room", 3, "did you mean mesh"},
       {"{ file \"room.obj\" }", "\"room.obj\"\n  animate room { translate 1 0 0 }", 3, "'mesh' is a block"},
       {"mesh room", "mesh 1room", 3, "a name that begins with a letter"},
       {"intensity 1 1 1", "irradiance 1 1 1", 4, "expected one of position, intensity"},
       {"intensity 1 1 1", "intensity 1.0f", 4, "unknown unit 'f'"},
       {"{ file \"room.obj\" }", "{ file \"room.obj\" }\n  animate rom { translate 1 0 0 }", 4,
        "unknown mesh 'rom'"},
       {"{ file \"room.obj\" }", "{ file \"room.obj\" material whit }\n  material white { diffuse 1 }", 3,
        "did you mean white"}});
}

TEST_CASE("one mistake in a pipeline gives one finding, at its line") {
  checkSlips(kPipeline, "slip.pipeline",
             {{"pipeline \"Cones\"", "pipeline \"Cones", 1, "the string is not closed"},
              {"pipeline \"Cones\" {", "", 2, "'param' stands outside of a block 'pipeline'"},
              {"pipeline \"Cones\" {", "pipeline {", 1, "the pipeline needs one name"},
              {"cones 6\n  }", "cones 6\n", 15, "by its indentation, 'pass cones voxel_cone_tracing.gather'"},
              {"cones 6", "cones 6 m", 18, "expected a number without a unit"},
              {"cones 6", "cones \"6", 18, "the string is not closed"},
              {"cones 6", "cones { 6 }", 18, "the value of a property has no braces"},
              {"cones 6", "cones 600", 18, "a whole number in 1..256"},
              {"cones 6", "cone 6", 18, "did you mean cones"},
              {"[16 32 64]", "[16, 32, 64]", 29, "unexpected ','"},
              {"[16 32 64]", "16 32 64", 29, "a sweep needs a list of values"},
              {"[16 32 64]", "[16 32 640]", 29, "does not fit the parameter 'resolution'"},
              {"resolution [16", "resolutoin [16", 29, "did you mean resolution"},
              {"1..512", "1..512 m", 2, "the range has a unit of length; expected no unit"},
              {"32 in 1..512", "32 1..512", 2, "malformed param"},
              {"1..512", "1-512", 2, "malformed number '1-512'"},
              {"param resolution", "parm resolution", 2, "did you mean param"},
              {"voxelization.conservative", "voxelization", 9, "a technique and one of its passes"},
              {"voxelization.conservative", "voxelisation.conservative", 9, "did you mean voxelization"},
              {"  pass shadow direct_lighting.shadow_map { }\n", "\n", 7, "unknown pass 'shadow'"},
              {"grid grid.mips", "grid grid.mip", 17, "did you mean mips"},
              {"$resolution", "$resolutoin", 9, "unknown parameter '$resolutoin'"},
              {"radiance light.radiance", "radiance grid.mips", 14, "cyclic dependency"},
              {"output final", "outptu final", 25, "did you mean output"},
              {"sweep quality", "swep quality", 28, "did you mean sweep"}});
}

TEST_CASE("one mistake in a sweep or a published table gives one finding, at its line") {
  const std::string cornell = (sourceDirectory() / "scenes/cornell.scene").string();
  const std::string cones = committedPipeline("voxel_cone_tracing");
  checkSlips("sweep \"Finer\" list {\n  scenes [\"" + cornell + "\"]\n  pipelines [\"" + cones +
                 "\"]\n  resolution [16 32]\n  cones [4 6]\n}\n",
             "slip.sweep",
             {{"  scenes [", "  scene [", 2, "the sweep lacks its scenes"},
              {"sweep \"Finer\"", "sweep \"Finer", 1, "the string is not closed"},
              {"sweep \"Finer\" list {", "", 2, "'scenes' stands outside of a block 'sweep'"},
              {"sweep \"Finer\"", "swep \"Finer\"", 1, "did you mean sweep"},
              {"list {", "lists {", 1, "did you mean list"},
              {"[16 32]", "[16 32 64]", 5, "'cones' has 2 values, but 'resolution' has 3"},
              {"[16 32]", "[16, 32]", 4, "unexpected ','"},
              {"[16 32]", "[16 32", 4, "the list is not closed"},
              {"[4 6]", "[4 6] }", 5, "or one '}' less"},
              {"resolution [", "resolutoin [", 4, "did you mean resolution"},
              {"cornell.scene", "cornel.scene", 2, "there is no file"}});
  checkSlips("reproduction \"t\" {\n  title \"a\"\n  paper \"b\"\n  scene \"" + cornell +
                 "\"\n  pipeline \"" + cones +
                 "\"\n  row \"one\" {\n    published 3\n    set { resolution 32 }\n  }\n}\n",
             "slip.reproduction",
             {{"published 3", "publishd 3", 7, "did you mean published"},
              {"title \"a\"", "title \"a", 2, "the string is not closed"},
              {"row \"one\"", "rwo \"one\"", 6, "did you mean row"},
              {"row \"one\" {", "row \"one\"", 6, "'row \"one\"' has no '{'"},
              {"published 3", "published 3 ms", 7, "expected a number without unit"},
              {"reproduction \"t\" {", "", 2, "'title' stands outside of a block 'reproduction'"},
              {"set { resolution 32 }", "set { resolutoin 32 }", 8, "did you mean resolution"},
              {"set { resolution 32 }", "set { resolution 32000 }", 8, "does not fit the parameter"},
              {"paper \"b\"", "paper b", 3, "does not suit property 'paper'"}});
}

TEST_CASE("check finds what only the models show, each at its line") {
  const Workplace place;
  place.write("parts.scene",
              replaced(replaced(kRoomScene, kLight, "light lamp area { mesh room/pannel  radiance 1 }"),
                       "\n  light", "\n  animate room/bx { translate 1 0 0 }\n  light"));
  const Checked parts = checked(place, "parts.scene");
  CHECK(parts.result.exitCode == 2);
  CHECK(contains(parts.text, "error 4: mesh 'room' has no object 'room/bx'; expected one of room/walls"));
  CHECK(contains(parts.text, "error 5: mesh 'room' has no object 'room/pannel'"));

  place.write("broken.obj", "v 0 0 0\nf 1 2 3\n");
  place.write("broken.scene",
              replaced(replaced(kRoomScene, "room.obj", "broken.obj"), "\n  light",
                       "\n  mesh other { file \"room.obj\" }\n  animate other/x { translate 1 0 0 }\n"
                       "  animate room/x { translate 1 0 0 }\n  light"));
  const Checked broken = checked(place, "broken.scene");
  INFO(broken.text);
  CHECK(broken.findings.size() == 2);  // Nothing is said of the objects of a mesh that cannot be read.
  CHECK(contains(broken.text, "broken.obj"));
  CHECK(contains(broken.text, "error 5: mesh 'other' has no object 'other/x'"));
}

TEST_CASE(
    "check finds faults of the text and of the files that it names in one go, in their order, and counts them") {
  const Workplace place;
  place.write("broken.obj", "v 0 0 0\nf 1 2 3\n");
  place.write("empty.obj", "v 0 0 0\n");
  place.write("cloud.vdb", "no volume");
  place.write("sky.png", "no image");
  place.write("all.scene",
              "scene \"All\" {\n"
              "  camera main { eye 0 0 0.9  target 0 0 0  fov 70  resolution 24 16 }\n"  // no unit
              "  material sky { texture \"sky.png\"  difuse 1 1 1 }\n"                   // misspelt
              "  mesh room { file \"room.obj\"  material white }\n"                      // unknown
              "  mesh broken { file \"broken.obj\"  crease -3 }\n"                       // no unit; broken
              "  mesh other { file \"room.obj\" material sky }\n"
              "  mesh gone { file \"gone.obj\"  scale 1 2 }\n"  // a number lacks; absent
              "  mesh empty { file \"empty.obj\" }\n"
              "  medium fog { file \"cloud.vdb\"  extinction -1  albedo 0.5 }\n"  // below 0; no volume
              "  light lamp area { mesh room/pannel  radiance 1 }\n"
              "  animate broken/any { translate 1 0 0 }\n"
              "}\n");
  const Checked all = checked(place, "all.scene");
  INFO(all.text);
  CHECK(all.result.exitCode == 2);
  for (const char* part :
       {"error 2: ", "error 3: unknown property 'difuse'", "error 3: ", "error 4: unknown material 'white'",
        "error 5: ", "broken.obj", "error 7: ", "error 7: model file 'gone.obj' does not exist",
        "error 8: ", "error 9: ", "cloud.vdb", "error 10: mesh 'room' has no object 'room/pannel'"})
    CHECK(contains(all.text, part));
  CHECK_FALSE(contains(all.text, "error 11: "));  // the objects of a mesh that cannot be read
  int last = 0;
  for (const auto& finding : all.findings) {
    if (finding.value("file", "") != place.file("all.scene")) continue;
    CHECK(finding.value("line", 0) >= last);
    last = finding.value("line", 0);
  }
  const CommandResult said = runCommand("lumivox check '" + place.file("all.scene") + "'");
  CHECK(contains(said.errors, "all.scene: " + std::to_string(all.findings.size()) + " errors"));

  // What is wrong with the files is the same once the text is mended.
  place.write(
      "models.scene",
      "scene \"Models\" {\n  camera main { eye 0 0 0.9  target 0 0 0  fov 70 deg }\n"
      "  material sky { texture \"sky.png\" }\n  mesh room { file \"room.obj\" }\n"
      "  mesh broken { file \"broken.obj\" }\n  mesh other { file \"room.obj\" material sky }\n"
      "  mesh gone { file \"gone.obj\" }\n  mesh empty { file \"empty.obj\" }\n"
      "  medium fog { file \"cloud.vdb\"  extinction 1 }\n  light lamp area { mesh room/pannel  radiance 1 }\n}\n");
  const Checked models = checked(place, "models.scene");
  INFO(models.text);
  CHECK(models.findings.size() >= 6);
  for (const auto& finding : models.findings)
    CHECK(contains(all.text, finding.value("what", "").substr(0, 40)));
}

TEST_CASE("check finds models and images that are nowhere or in a format that cannot be read") {
  const Workplace place;
  place.write("room.gltf", "{}");
  place.write("sky.exr", "v/1");
  checkSlips(
      kRoomScene, "files.scene",
      {{"room.obj", "models/room.obj", 3,
        "model file 'models/room.obj' does not exist; expected it at one of"},
       {"room.obj", "rom.obj", 3, "did you mean room.obj"},
       {"room.obj", "room.gltf", 3, "has a format that cannot be read; expected one of .obj, .obj.gz"},
       {"  mesh", "  material m { texture \"sky.exr\" }\n  mesh", 3,
        "image file 'sky.exr' has a format that cannot be read; expected one of .png, .jpg, .jpeg, .tga"},
       {"  mesh", "  material m { mask \"gone.png\" }\n  mesh", 3, "image file 'gone.png' does not exist"}});
  const CommandResult folder = runCommand("lumivox check --assets /nonexistent '" + place.scene() + "'");
  checkRefused(folder, "/nonexistent");
}

TEST_CASE("check warns of a missing MTL file, and names MTL file and line of a missing image") {
  const Workplace place;
  place.write("room.obj", replaced(kRoomObj, "room.mtl", "gone.mtl"));
  const Checked mtl = checked(place, "room.scene");
  INFO(mtl.text);
  CHECK(mtl.result.exitCode == 0);
  CHECK(mtl.findings.size() == 1);
  CHECK(contains(mtl.text, "warning 3: "));
  CHECK(contains(mtl.text, "gone.mtl' does not exist"));
  const CommandResult said = runCommand("lumivox check '" + place.scene() + "'");
  CHECK(contains(said.output, "room.scene: good, with 1 warning\n"));
  CHECK_FALSE(contains(said.errors, "warning: warning"));

  place.write("room.obj", kRoomObj);
  place.write("room.mtl", std::string("newmtl other\nKd 1 1 1\n") + kRoomMtl + "map_Kd gone.png\n");
  for (const char* command : {"check", "reference"}) {
    const CommandResult image =
        runCommand(std::string("lumivox ") + command + " '" + place.scene() + "'" +
                   (command == std::string("check") ? "" : " -o '" + place.file("a.exr") + "'"));
    INFO(command << image.errors);
    CHECK(image.exitCode == 2);
    CHECK(contains(image.errors,
                   "room.mtl:5: the image 'gone.png' of material 'grey' (map_Kd) does not exist"));
  }
}

TEST_CASE("check warns of connections that give wrong light, and of nothing in good ones") {
  const Workplace place;
  place.write("good.pipeline", kPipeline);
  const CommandResult good = runCommand("lumivox check '" + place.file("good.pipeline") + "'");
  CHECK(good.errors.empty());
  CHECK(contains(good.output, "good.pipeline: good\n"));

  place.write("swapped.pipeline",
              replaced(replaced(kPipeline, "diffuse cones.diffuse", "diffuse cones.glossy"),
                       "glossy cones.glossy\n  }", "glossy direct\n  }"));
  const Checked swapped = checked(place, "swapped.pipeline");
  INFO(swapped.text);
  CHECK(swapped.result.exitCode == 0);
  CHECK(swapped.findings.size() == 2);
  CHECK(contains(
      swapped.text,
      "warning 22: output 'cones.glossy' holds indirect_glossy, but input 'diffuse' of pass 'compose' takes "
      "indirect_diffuse"));
  CHECK(contains(swapped.text, "did you mean cones.diffuse"));
  CHECK(contains(swapped.text, "warning 23: output 'direct.radiance' holds direct"));

  place.write("unfiltered.pipeline", replaced(kPipeline, "grid grid.mips", "grid light"));
  const Checked unfiltered = checked(place, "unfiltered.pipeline");
  INFO(unfiltered.text);
  CHECK(unfiltered.result.exitCode == 0);
  CHECK(unfiltered.findings.size() == 1);
  CHECK(contains(unfiltered.text, "warning 17: output 'light.radiance' fills only the finest level"));
  CHECK(contains(unfiltered.text, "did you mean grid.mips"));
  const CommandResult said = runCommand("lumivox check '" + place.file("unfiltered.pipeline") + "'");
  CHECK(contains(said.errors, "unfiltered.pipeline:17:10: warning: output"));
  CHECK_FALSE(contains(said.errors, "warning: " + place.path().string()));
  CHECK(contains(said.output, "good, with 1 warning\n"));
}

TEST_CASE("models beside the project are sought from where the text lies, not from where the command runs") {
  const Workplace place;
  place.write("lab/scenes/deep/a.scene", replaced(kRoomScene, "room.obj", "far/room.obj"));
  place.write("shared/models/far/room.obj", kRoomObj);
  place.write("shared/models/far/room.mtl", kRoomMtl);
  place.write("elsewhere/shared/models/near/room.obj", kRoomObj);
  place.write("elsewhere/desk/x", "");
  const std::string scene = "'" + place.file("lab/scenes/deep/a.scene") + "'";
  CHECK(runCommand("lumivox check " + scene).exitCode == 0);
  place.write("lab/scenes/deep/a.scene", replaced(kRoomScene, "room.obj", "near/room.obj"));
  const CommandResult other = runCommand("cd '" + place.file("elsewhere/desk") + "' && " +
                                         (binaryDirectory() / "bin/lumivox").string() + " check " + scene);
  CHECK(other.exitCode == 2);
  CHECK_FALSE(contains(other.errors, "elsewhere"));
}

TEST_CASE("describe writes the ends of ranges as they were given") {
  CHECK(contains(runCommand("lumivox describe voxel_cone_tracing.gather").output, "a number in 0.05..2"));
}
