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

/// What check finds in files, by one command.
std::vector<Checked> checkedAll(const Workplace& place, const std::vector<std::string>& names) {
  std::string files;
  for (const std::string& name : names) files += " '" + place.file(name) + "'";
  const CommandResult result = typed("check --json", files.c_str());
  INFO(result.output << result.errors);
  std::vector<Checked> all;
  for (const auto& json : nlohmann::json::parse(result.output)) {
    Checked& one = all.emplace_back(Checked{result, json["findings"], ""});
    for (const auto& finding : one.findings)
      one.text += finding.value("severity", "") + " " + std::to_string(finding.value("line", 0)) + ": " +
                  finding.value("what", "") + "; expected " + finding.value("expected", "") +
                  "; did you mean " + finding.value("suggestion", "") + "\n";
  }
  REQUIRE(all.size() == names.size());
  return all;
}
Checked checked(const Workplace& place, const std::string& name) {
  return checkedAll(place, {name}).front();
}

/// A slip in one of the good texts, and the facts of its only finding.
struct Slip {
  const char* part;
  const char* by;
  int line;
  Tells facts;
};
Tells meant(const char* word) {
  return Tells("did you mean", word);
}

void checkSlips(const std::string& good, const std::string& kind, const std::vector<Slip>& slips) {
  const Workplace place;
  std::vector<std::string> names;
  for (const Slip& slip : slips) {
    names.push_back("slip" + std::to_string(names.size()) + kind);
    place.write(names.back(), replaced(good, slip.part, slip.by));
  }
  const std::vector<Checked> all = checkedAll(place, names);
  CHECK(all.front().result.exitCode == 2);
  for (std::size_t i = 0; i < slips.size(); ++i) {
    INFO(slips[i].part << " -> " << slips[i].by << "\n" << all[i].text);
    CHECK(all[i].findings.size() == 1);
    if (all[i].findings.empty()) continue;
    CHECK(all[i].findings[0].value("severity", "") == "error");
    CHECK(all[i].findings[0].value("line", 0) == slips[i].line);
    CHECK_THAT(all[i].text, slips[i].facts);
    CHECK_FALSE(contains(all[i].text, "measures no unit"));
  }
}

const Tells kNotClosed("string", "not closed");

}  // namespace

TEST_CASE("one mistake in a scene gives one finding, at its line") {
  const std::string accent = "light accent spotlight { position 0 0 0  direction 0 -1 0  intensity 1 }";
  checkSlips(
      kRoomScene, ".scene",
      {{kLight, accent.c_str(), 4,
        Tells("spotlight", "light", "area", "directional", "point", "spot", "mean", "spot")},
       {kLight, "light bulb { position 0.2 0.5 0  intensity 1 1 1 }", 4, Tells("light bulb", "kind")},
       {kLight, "light point main { position 0.2 0.5 0  intensity 1 1 1 }", 4, meant("light main point")},
       {"\"room.obj\"", "\"room.obj", 3, kNotClosed},
       {"file \"room.obj\"", "file room.obj\"", 3, kNotClosed},
       {"scene \"Little room\"", "scene \"Little room", 1, kNotClosed},
       {"{ file \"room.obj\" }", "{ file \"room.obj\" use { part walls  material white } }", 3,
        Tells("line break", "use")},
       {"eye 0 0 0.9", "eye 0, 0, 0.9", 2, Tells("','")},
       {"eye 0 0 0.9", "eye (0 0 0.9)", 2, Tells("parentheses")},
       {"intensity 1 1 1", "intensity 0,5", 4, Tells("'.'", "decimal")},
       {"fov 70 deg", "fov 70 degrees", 2, Tells("degrees", "angle", "39 deg", "mean", "deg")},
       {"fov 70 deg", "fov = 70 deg", 2, Tells("'='")},
       {"fov 70 deg", "fov 70", 2, Tells("no unit")},
       {"resolution 24 16", "resolution 24x16", 2, Tells("blank", "24 16")},
       {"resolution 24 16", "resolution 24 x 16", 2, Tells("resolution", 1)},
       {"\"room.obj\"", "'room.obj'", 3, Tells("single quotes", "\"room.obj\"")},
       {"  light", "  // the lamp\n  light", 4, Tells("'//'", "'#'")},
       {"  light", "  /* the\n  lamp */\n  light", 4, Tells("'/*'")},
       {"camera main { eye", "camera main eye", 2, Tells("'}'", "scene \"Little room\"", 1)},
       {"intensity 1 1 1 }", "intensity 1 1 1 } }", 4, Tells("'}'", "less")},
       {"intensity 1 1 1 }", "intensity 1 1 1", 4, Tells("light bulb point", "lacks")},
       {"file \"room.obj\" }", "file \"room.obj\"", 3, Tells("mesh room", "lacks")},
       {"scene \"Little room\" {", "", 2, Tells("camera", "outside", "scene")},
       {"scene \"Little room\"", "scene Little room", 1, Tells("\"Little room\"", "double quotes")},
       {"camera main", "camra main", 2, meant("camera")},
       {"camera main", "Camera main", 2, meant("camera")},
       {"mesh room", "mash room", 3, meant("mesh")},
       {"{ file \"room.obj\" }", "\"room.obj\"\n  animate room { translate 1 0 0 }", 3,
        Tells("mesh", "block")},
       {"mesh room", "mesh 1room", 3, Tells("name", "letter")},
       {"intensity 1 1 1", "irradiance 1 1 1", 4, Tells("irradiance", "position", "intensity")},
       {"intensity 1 1 1", "intensity 1.0f", 4, Tells("unit", "f")},
       {"{ file \"room.obj\" }", "{ file \"room.obj\" }\n  animate rom { translate 1 0 0 }", 4,
        Tells("mesh", "rom")},
       {"{ file \"room.obj\" }", "{ file \"room.obj\" material whit }\n  material white { diffuse 1 }", 3,
        meant("white")}});
}

TEST_CASE("one mistake in a pipeline gives one finding, at its line") {
  checkSlips(kPipeline, ".pipeline",
             {{"pipeline \"Cones\"", "pipeline \"Cones", 1, kNotClosed},
              {"pipeline \"Cones\" {", "", 2, Tells("param", "outside", "pipeline")},
              {"pipeline \"Cones\" {", "pipeline {", 1, Tells("pipeline", "one name")},
              {"cones 6\n  }", "cones 6\n", 15, Tells("pass cones voxel_cone_tracing.gather")},
              {"cones 6", "cones 6 m", 18, Tells("number", "without", "unit")},
              {"cones 6", "cones \"6", 18, kNotClosed},
              {"cones 6", "cones { 6 }", 18, Tells("property", "braces")},
              {"cones 6", "cones 600", 18, Tells("1..256")},
              {"cones 6", "cone 6", 18, meant("cones")},
              {"[16 32 64]", "[16, 32, 64]", 29, Tells("','")},
              {"[16 32 64]", "16 32 64", 29, Tells("sweep", "list")},
              {"[16 32 64]", "[16 32 640]", 29, Tells("resolution")},
              {"resolution [16", "resolutoin [16", 29, meant("resolution")},
              {"1..512", "1..512 m", 2, Tells("unit", "length", "no unit")},
              {"32 in 1..512", "32 1..512", 2, Tells("param")},
              {"1..512", "1-512", 2, Tells("1-512")},
              {"param resolution", "parm resolution", 2, meant("param")},
              {"voxelization.conservative", "voxelization", 9, Tells("technique", "passes")},
              {"voxelization.conservative", "voxelisation.conservative", 9, meant("voxelization")},
              {"  pass shadow direct_lighting.shadow_map { }\n", "\n", 7, Tells("pass", "shadow")},
              {"grid grid.mips", "grid grid.mip", 17, meant("mips")},
              {"$resolution", "$resolutoin", 9, Tells("$resolutoin")},
              {"radiance light.radiance", "radiance grid.mips", 14, Tells("cyclic")},
              {"output final", "outptu final", 25, meant("output")},
              {"sweep quality", "swep quality", 28, meant("sweep")}});
}

TEST_CASE("one mistake in a sweep or a published table gives one finding, at its line") {
  const std::string cornell = (sourceDirectory() / "scenes/cornell.scene").string();
  const std::string cones = committedPipeline("voxel_cone_tracing");
  checkSlips("sweep \"Finer\" list {\n  scenes [\"" + cornell + "\"]\n  pipelines [\"" + cones +
                 "\"]\n  resolution [16 32]\n  cones [4 6]\n}\n",
             ".sweep",
             {{"  scenes [", "  scene [", 2, Tells("sweep", "lacks", "scenes")},
              {"sweep \"Finer\"", "sweep \"Finer", 1, kNotClosed},
              {"sweep \"Finer\" list {", "", 2, Tells("scenes", "outside", "sweep")},
              {"sweep \"Finer\"", "swep \"Finer\"", 1, meant("sweep")},
              {"list {", "lists {", 1, meant("list")},
              {"[16 32]", "[16 32 64]", 5, Tells("cones", 2, "resolution", 3)},
              {"[16 32]", "[16, 32]", 4, Tells("','")},
              {"[16 32]", "[16 32", 4, Tells("list", "not closed")},
              {"[4 6]", "[4 6] }", 5, Tells("'}'", "less")},
              {"resolution [", "resolutoin [", 4, meant("resolution")},
              {"cornell.scene", "cornel.scene", 2, Tells("no file")}});
  checkSlips("reproduction \"t\" {\n  title \"a\"\n  paper \"b\"\n  scene \"" + cornell +
                 "\"\n  pipeline \"" + cones +
                 "\"\n  row \"one\" {\n    published 3\n    set { resolution 32 }\n  }\n}\n",
             ".reproduction",
             {{"published 3", "publishd 3", 7, meant("published")},
              {"title \"a\"", "title \"a", 2, kNotClosed},
              {"row \"one\"", "rwo \"one\"", 6, meant("row")},
              {"row \"one\" {", "row \"one\"", 6, Tells("row \"one\"", "'{'")},
              {"published 3", "published 3 ms", 7, Tells("number", "without", "unit")},
              {"reproduction \"t\" {", "", 2, Tells("title", "outside", "reproduction")},
              {"set { resolution 32 }", "set { resolutoin 32 }", 8, meant("resolution")},
              {"set { resolution 32 }", "set { resolution 32000 }", 8, Tells("resolution")},
              {"paper \"b\"", "paper b", 3, Tells("paper")}});
}

TEST_CASE("check finds what only the models show, each at its line") {
  const Workplace place;
  place.write("parts.scene",
              replaced(replaced(kRoomScene, kLight, "light lamp area { mesh room/pannel  radiance 1 }"),
                       "\n  light", "\n  animate room/bx { translate 1 0 0 }\n  light"));
  const Checked parts = checked(place, "parts.scene");
  CHECK(parts.result.exitCode == 2);
  CHECK_THAT(parts.text, Tells("error 4", "room", "room/bx", "room/walls", "error 5", "room", "room/pannel"));

  place.write("broken.obj", "v 0 0 0\nf 1 2 3\n");
  place.write("broken.scene",
              replaced(replaced(kRoomScene, "room.obj", "broken.obj"), "\n  light",
                       "\n  mesh other { file \"room.obj\" }\n  animate other/x { translate 1 0 0 }\n"
                       "  animate room/x { translate 1 0 0 }\n  light"));
  const Checked broken = checked(place, "broken.scene");
  INFO(broken.text);
  CHECK(broken.findings.size() == 2);  // Nothing is said of the objects of a mesh that cannot be read.
  CHECK_THAT(broken.text, Tells("broken.obj") && Tells("error 5", "other", "other/x"));
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
  for (const Tells& one :
       {Tells("error 2"), Tells("error 3", "difuse"), Tells("error 3", "sky.png"), Tells("error 4", "white"),
        Tells("error 5", "crease"), Tells("broken.obj"), Tells("error 7", "gone.obj"), Tells("error 8"),
        Tells("error 9", "cloud.vdb"), Tells("error 10", "room", "room/pannel")})
    CHECK_THAT(all.text, one);
  CHECK_FALSE(contains(all.text, "error 11: "));  // the objects of a mesh that cannot be read
  int last = 0;
  for (const auto& finding : all.findings) {
    if (finding.value("file", "") != place.file("all.scene")) continue;
    CHECK(finding.value("line", 0) >= last);
    last = finding.value("line", 0);
  }
  const CommandResult said = typed("check", place.file("all.scene"));
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
  place.write("room.fbx", "{}");
  place.write("sky.exr", "v/1");
  checkSlips(kRoomScene, ".scene",
             {{"room.obj", "models/room.obj", 3, Tells("models/room.obj", "not exist")},
              {"room.obj", "rom.obj", 3, meant("room.obj")},
              {"room.obj", "room.fbx", 3, Tells("room.fbx", ".obj", ".obj.gz")},
              {"  mesh", "  material m { texture \"sky.exr\" }\n  mesh", 3,
               Tells("sky.exr", ".png", ".jpg", ".jpeg", ".tga")},
              {"  mesh", "  material m { mask \"gone.png\" }\n  mesh", 3, Tells("gone.png", "not exist")}});
  checkRefused(typed("check --assets /nonexistent", place.scene()), "/nonexistent");
}

TEST_CASE("check warns of a missing MTL file, and names MTL file and line of a missing image") {
  const Workplace place;
  place.write("room.obj", replaced(kRoomObj, "room.mtl", "gone.mtl"));
  const Checked mtl = checked(place, "room.scene");
  INFO(mtl.text);
  CHECK(mtl.result.exitCode == 0);
  CHECK(mtl.findings.size() == 1);
  CHECK_THAT(mtl.text, Tells("warning 3", "gone.mtl", "not exist"));
  const CommandResult said = typed("check", place.scene());
  CHECK_THAT(said.output, Tells("room.scene", "good", 1, "warning"));
  CHECK_FALSE(contains(said.errors, "warning: warning"));

  place.write("room.obj", kRoomObj);
  place.write("room.mtl", std::string("newmtl other\nKd 1 1 1\n") + kRoomMtl + "map_Kd gone.png\n");
  for (const CommandResult& image :
       {typed("check", place.scene()), typed("reference", place.scene(), "-o", place.file("a.exr"))}) {
    INFO(image.errors);
    CHECK(image.exitCode == 2);
    CHECK_THAT(image.errors, Tells("room.mtl:5", "gone.png", "grey", "map_Kd"));
  }
}

TEST_CASE("check warns of connections that give wrong light, and of nothing in good ones") {
  const Workplace place;
  place.write("good.pipeline", kPipeline);
  const CommandResult good = typed("check", place.file("good.pipeline"));
  CHECK(good.errors.empty());
  CHECK(contains(good.output, "good.pipeline: good\n"));

  place.write("swapped.pipeline",
              replaced(replaced(kPipeline, "diffuse cones.diffuse", "diffuse cones.glossy"),
                       "glossy cones.glossy\n  }", "glossy direct\n  }"));
  place.write("unfiltered.pipeline", replaced(kPipeline, "grid grid.mips", "grid light"));
  const std::vector<Checked> all = checkedAll(place, {"swapped.pipeline", "unfiltered.pipeline"});
  CHECK(all[0].result.exitCode == 0);
  CHECK(all[0].findings.size() == 2);
  CHECK_THAT(all[0].text,
             Tells("warning 22", "cones.glossy", "indirect_glossy", "diffuse", "compose", "indirect_diffuse",
                   "mean", "cones.diffuse", "warning 23", "direct.radiance", "direct"));
  CHECK(all[1].findings.size() == 1);
  CHECK_THAT(all[1].text, Tells("warning 17", "light.radiance", "finest", "mean", "grid.mips"));
  const CommandResult said = typed("check", place.file("unfiltered.pipeline"));
  CHECK_THAT(said.errors, Tells("unfiltered.pipeline:17:10", "warning", "output"));
  CHECK_FALSE(contains(said.errors, "warning: " + place.path().string()));
  CHECK_THAT(said.output, Tells("good", 1, "warning"));
}

TEST_CASE("models beside the project are sought from where the text lies, not from where the command runs") {
  const Workplace place;
  place.write("lab/scenes/deep/a.scene", replaced(kRoomScene, "room.obj", "far/room.obj"));
  place.write("shared/models/far/room.obj", kRoomObj);
  place.write("shared/models/far/room.mtl", kRoomMtl);
  place.write("elsewhere/shared/models/near/room.obj", kRoomObj);
  place.write("elsewhere/desk/x", "");
  ran("check", place.file("lab/scenes/deep/a.scene"));
  place.write("lab/scenes/deep/a.scene", replaced(kRoomScene, "room.obj", "near/room.obj"));
  const CommandResult other =
      typed(in(place / "elsewhere/desk"), "check", place.file("lab/scenes/deep/a.scene"));
  CHECK(other.exitCode == 2);
  CHECK_FALSE(contains(other.errors, "elsewhere"));
}

TEST_CASE("describe writes the ends of ranges as they were given") {
  CHECK_THAT(typed("describe voxel_cone_tracing.gather").output, Catch::Contains(" 0.05..2;"));
}
