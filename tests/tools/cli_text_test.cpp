// check, fmt, describe and list on real files.
#include <algorithm>
#include <set>

#include "lumivox/base/file.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("check reports all findings of all files at once, each with its place, and exits with 2") {
  const Workplace place;
  place.write("wrong.scene",
              "scene \"Wrong\" {\n"
              "  camera main { eye 0 0 1  target 0 0 0  fow 30 deg }\n"
              "  mesh room { file \"room.obj\"  colour 1 }\n"
              "}\n");
  place.write("wrong.pipeline", "pipeline \"Wrong\" {\n  param size 64 in 1..32\n}\n");
  const CommandResult result =
      typed("check", place.file("wrong.scene"), place.scene(), place.file("wrong.pipeline"));
  INFO(result.errors);
  CHECK(result.exitCode == 2);
  CHECK(contains(result.errors, "wrong.scene:2:42: "));
  CHECK(contains(result.errors, "did you mean 'fov'"));
  CHECK(contains(result.errors, "wrong.scene:3:32: "));
  CHECK(contains(result.errors, "wrong.pipeline:2:"));
  CHECK(contains(result.output, "room.scene: good"));
}

TEST_CASE("check --json holds the same findings as the text") {
  const Workplace place;
  place.write("wrong.scene", "scene \"Wrong\" {\n  camera main { eye 0 0 1  target 0 0 0  fow 30 deg }\n}\n");
  const CommandResult result = typed("check --json", place.file("wrong.scene"), place.scene());
  CHECK(result.exitCode == 2);
  const auto json = nlohmann::json::parse(result.output);
  REQUIRE(json.size() == 2);
  CHECK_FALSE(json[0]["good"].get<bool>());
  REQUIRE_FALSE(json[0]["findings"].empty());
  CHECK(json[0]["findings"][0]["line"] == 2);
  CHECK(json[0]["findings"][0]["suggestion"] == "fov");
  CHECK(json[1]["good"].get<bool>());
  CHECK(json[1]["findings"].empty());
}

TEST_CASE(
    "check refuses what is no text of ours: missing, empty, binary, a folder, neither scene nor pipeline") {
  const Workplace place;
  place.write("empty.scene", "");
  place.write("binary.scene", std::string("\x7f"
                                          "ELF\0\0\x01\xff\xfe",
                                          9));
  place.write("open.scene", "scene \"Open\" {\n  camera main { eye 0 0 1\n");
  place.write("notes.txt", "remember the milk\n");
  for (const char* name :
       {"missing.scene", "missing.pipeline", "empty.scene", "binary.scene", "open.scene", "notes.txt"}) {
    const CommandResult result = typed("check", place.file(name));
    INFO(name);
    checkRefused(result, name);
  }
  checkRefused(typed("check", place.path()), place.path().string());
}

TEST_CASE("every committed scene and pipeline passes check") {
  if (!std::filesystem::exists(sourceDirectory() / "../shared/models"))
    return skip("the models of some scenes are not on this machine");
  const std::string scenes = "'" + (sourceDirectory() / "scenes").string() + "'";
  const CommandResult pipelines = typed("check", Raw{scenes + "/pipelines/*.pipeline"});
  INFO(pipelines.errors);
  CHECK(pipelines.exitCode == 0);
  CHECK(pipelines.errors.empty());
  const CommandResult texts =
      typed("check --json", Raw{scenes + "/*.scene"}, Raw{scenes + "/stress/*.scene"});
  INFO(texts.output << texts.errors);
  CHECK(texts.exitCode == 0);
  CHECK(texts.errors.empty());
  // Models as they are found have triangles of zero area and maps that are not used.
  for (const auto& text : nlohmann::json::parse(texts.output))
    for (const auto& finding : text["findings"]) CHECK(finding["severity"] == "warning");
}

TEST_CASE("fmt lays out in place, keeps comments, and a second run changes nothing") {
  const Workplace place;
  place.write("ugly.scene",
              "# a room\nscene   \"Ugly\"{ camera main{eye 0 0 1 target 0 0 0} # the eye\n mesh room {file "
              "\"room.obj\"}}");
  const std::string quoted = "'" + place.file("ugly.scene") + "'";
  CHECK(typed("fmt --check", Raw{quoted}).exitCode == 1);
  const CommandResult first = ran("fmt", Raw{quoted});
  const std::string once = place.read("ugly.scene");
  CHECK(contains(once, "# a room"));
  CHECK(contains(once, "# the eye"));
  CHECK(typed("fmt --check", Raw{quoted}).exitCode == 0);
  CHECK(typed("fmt", Raw{quoted}).exitCode == 0);
  CHECK(place.read("ugly.scene") == once);
}

TEST_CASE("fmt touches no file when one of them is wrong") {
  const Workplace place;
  const std::string ugly = "scene   \"Ugly\"{ camera main{eye 0 0 1 target 0 0 0} }";
  place.write("ugly.scene", ugly);
  place.write("wrong.scene", "scene \"Wrong\" { camera main { eye 0 0 1 }\n");
  checkRefused(typed("fmt", place.file("ugly.scene"), place.file("wrong.scene")), "wrong.scene");
  CHECK(place.read("ugly.scene") == ugly);
}

TEST_CASE("describe knows the words of both texts and names the nearest for one that it does not know") {
  for (const char* word : {"camera", "fov", "material", "pass", "sweep"}) {
    INFO(word);
    const CommandResult result = typed("describe", word);
    CHECK(result.exitCode == 0);
    CHECK(contains(result.output, word));
  }
  CHECK(contains(typed("describe fov").output, "deg"));
  const CommandResult unknown = typed("describe fow");
  checkRefused(unknown, "did you mean 'fov'");
  checkRefused(typed("describe"), "expected a word");
}

TEST_CASE("describe knows techniques, passes, ports and parameters from the libraries") {
  CHECK(contains(typed("describe direct_lighting").output, "technique direct_lighting"));
  const CommandResult pass = typed("describe voxel_cone_tracing.gather");
  INFO(pass.errors);
  CHECK(contains(pass.output, "inputs"));
  CHECK(contains(pass.output, "cones"));
  CHECK(contains(typed("describe cones").output, "parameter cones of voxel_cone_tracing.gather"));
  CHECK(contains(typed("describe gbuffer").output, "direct_lighting.gbuffer"));
}

TEST_CASE("describe says what readers of a kind must heed, and what they get otherwise") {
  const std::string light = typed("describe ShGrid").output;
  INFO(light);
  for (const char* text :
       {"readers heed quantity: flux", "readers heed unit: the value that the number 1 stands for",
        "too bright or too dark by this factor", "readers heed readFor: the one reading"})
    CHECK(contains(light, text));
  CHECK(contains(typed("describe RadianceGrid").output, "readers of coarser levels heed opacity: "));
  CHECK_FALSE(contains(typed("describe BinaryGrid").output, "heed"));
  CHECK(contains(typed("describe --markdown").output,
                 "`opacity` (readers of coarser levels): whether the opacity of a coarser voxel"));
}

TEST_CASE("describe --markdown is the whole reference") {
  const CommandResult result = typed("describe --markdown");
  CHECK(result.exitCode == 0);
  for (const char* part :
       {"## Scene texts", "## Pipeline texts", "## Techniques", "### direct_lighting", "`cones`", "`fov`"})
    CHECK(contains(result.output, part));
}

TEST_CASE("list names the committed texts and the built techniques, and its JSON parses") {
  const auto names = [](const std::string& what) {
    const CommandResult result = ran("list", Raw{what}, "--json");
    std::vector<std::string> list;
    for (const auto& entry : nlohmann::json::parse(result.output)) list.push_back(entry.at("name"));
    return list;
  };
  const auto has = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  CHECK(has(names("scenes"), "cornell"));
  CHECK(has(names("pipelines"), "voxel_cone_tracing"));
  CHECK(has(names("techniques"), "voxelization"));
  CHECK(has(names("passes"), "direct_lighting.gbuffer"));
  CHECK(contains(typed("list scenes").output, "Cornell box"));
  CHECK(typed("list gardens").exitCode == 2);
}

TEST_CASE("a technique library that is broken is reported with its path, and the others are still listed") {
  const Workplace place;
  place.write("plugins/libbroken.so", "this is no library");
  const CommandResult result = typed("list techniques --techniques", place.file("plugins"), "--techniques",
                                     binaryDirectory() / "lib/techniques");
  CHECK(result.exitCode == 0);
  CHECK(contains(result.errors, "libbroken.so"));
  CHECK(contains(result.output, "direct_lighting"));
}

TEST_CASE("unknown commands and options are bad input, help and version are not") {
  CHECK(typed("").exitCode == 2);
  CHECK(typed("paint").exitCode == 2);
  CHECK(typed("render --colour red").exitCode == 2);
  CHECK(typed("--help").exitCode == 0);
  CHECK(typed("report --help").exitCode == 0);
  CHECK(contains(typed("--version").output, "lumivox "));
}

TEST_CASE("the reference in docs is what describe --markdown writes today") {
  const CommandResult result = ran("describe --markdown");
  const bool same = result.output == readFile(sourceDirectory() / "docs/reference.md");
  INFO("bring it up to date: ./run describe --markdown > docs/reference.md");
  CHECK(same);
}

TEST_CASE("describe answers in JSON with numbers in base units, and switches and words as what they are") {
  using Json = nlohmann::json;
  const auto described = [](const std::string& word) {
    return Json::parse(typed("describe", Raw{word}, "--json").output).at("found");
  };
  const auto member = [](const Json& list, const std::string& word) {
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const Json& one) { return one.at("word") == word; });
    REQUIRE(found != list.end());
    return *found;
  };
  const Json camera = described("camera").at(0);
  CHECK(camera.at("what") == "block");
  CHECK(camera.at("in") == Json::array({"scene"}));
  const Json fov = member(camera.at("properties"), "fov");
  const double degree = std::acos(-1.0) / 180.0;
  CHECK(fov.at("unit") == "rad");
  CHECK(fov.at("default").get<double>() == Approx(40 * degree));
  CHECK(fov.at("low").get<double>() == Approx(0.1 * degree));
  CHECK(fov.at("high").get<double>() == Approx(179 * degree));
  CHECK(member(camera.at("properties"), "up").at("default") == Json::array({0.0, 1.0, 0.0}));
  CHECK(member(camera.at("properties"), "resolution").at("default") == Json::array({256.0, 256.0}));
  CHECK(member(camera.at("properties"), "eye").at("low") == -1e9);
  CHECK_FALSE(member(described("mesh").at(0).at("properties"), "file").contains("low"));
  CHECK(member(described("light").at(0).at("kinds").at("spot"), "intensity").at("required") == true);

  const Json gather = described("voxel_cone_tracing.gather").at(0);
  CHECK(gather.at("what") == "pass");
  CHECK(member(gather.at("inputs"), "grid").at("levels") == "all");
  CHECK(member(gather.at("outputs"), "diffuse").at("component") == "indirect_diffuse");
  const Json cones = member(gather.at("parameters"), "cones"), step = member(gather.at("parameters"), "step");
  CHECK(cones.at("type") == "integer");
  CHECK(cones.at("default") == 6);
  CHECK(cones.at("high") == 256);
  CHECK(step.at("low") == 0.05);  // and not the float nearest to it
  CHECK(member(described("near_field_voxels.gather").at(0).at("parameters"), "as_published").at("default") ==
        false);
  CHECK(member(gather.at("parameters"), "distribution").at("choices") ==
        Json::array({"cosine", "published"}));
  CHECK(member(gather.at("parameters"), "reach").at("unit") == "m");
  std::set<std::string> withCones;
  for (const Json& one : described("cones")) withCones.insert(one.at("pass").get<std::string>());
  CHECK(withCones.contains("voxel_cone_tracing.gather"));
  CHECK(described("RadianceGrid").at(0).at("exported").size() == 2);
  const Json heeded = described("RadianceGrid").at(0).at("heeded");
  REQUIRE(heeded.size() == 4);
  CHECK(heeded.at(0).at("member") == "unit");
  CHECK(heeded.at(0).at("readers") == "");
  CHECK(heeded.at(2).at("readers") == "of coarser levels");
  CHECK(described("voxelization").at(0).at("what") == "technique");
  checkRefused(typed("describe conse --json"), "conse");
}
