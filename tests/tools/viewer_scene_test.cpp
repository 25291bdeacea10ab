// What is changed in a scene while it is shown, and how its text says it afterwards.
#include <algorithm>

#include "lumivox/scene/text.h"
#include "tools/viewer_support.h"
#include "viewer/panels.h"
#include "viewer/scene_edits.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::viewer;

namespace {

constexpr const char* kEverything =
    "scene \"Everything\" {\n"
    "  # a remark that stays\n"
    "  camera main { eye 0 0 0.9  target 0 0 -1  fov 70 deg  resolution 24 16 }\n"
    "  camera path {\n"
    "    key { time 0  eye 0 0 0.9  target 0 0 -1 }\n"
    "    key { time 1  eye 0.1 0 0.9  target 0 0 -1 }\n"
    "  }\n"
    "  material paint { diffuse 0.5  specular 0.2  exponent 20 }\n"
    "  mesh room { file \"room.obj\" }\n"
    "  mesh box { file \"room.obj\"  material paint  scale 0.2 }\n"
    "  light bulb point { position 0 0.5 0  intensity 1 }\n"
    "  light sun directional { direction 0 -1 0.1  irradiance 2 }\n"
    "  light cone spot { position 0 0.5 0  direction 0 -1 0  intensity 3  inner 10 deg  outer 20 deg }\n"
    "  light lamp area { mesh box  radiance 4 }\n"
    "  environment { radiance 0.1 }\n"
    "  medium fog { extinction 0.2 /m  albedo 0.5 }\n"
    "}\n";

const Material& materialOf(const Scene& scene, const std::string& object) {
  const auto found = std::find_if(scene.objects.begin(), scene.objects.end(),
                                  [&](const Object& one) { return one.name == object; });
  REQUIRE(found != scene.objects.end());
  return scene.materials[static_cast<std::size_t>(found->parts.front().material)];
}

/// The edits, written and read again.
Scene writtenAndRead(const Scene& scene, const SceneEdits& edits, std::string* text = nullptr) {
  const std::string written = textWithEdits(scene, edits, nullptr, {});
  CHECK(dsl::format(dsl::parse(written, "written")) == written);  // the canonical layout
  if (text != nullptr) *text = written;
  return loadSceneText(written, scene.file);
}

const Row& rowOf(const std::vector<Panel>& panels, const std::string& panel, const std::string& name) {
  for (const Panel& one : panels)
    if (one.name == panel)
      for (const Row& row : one.rows)
        if (row.name == name) return row;
  FAIL("no row " << name << " in panel " << panel);
  throw Error("unreachable");
}

}  // namespace

TEST_CASE("lights, surfaces, media and cameras are written as they were edited, and nothing else is") {
  const Workplace place;
  place.write("all.scene", kEverything);
  const Scene scene = loadScene(place.file("all.scene"));
  SceneEdits edits;
  edits.powers = {{"bulb", {1, 2, 3}}, {"sun", {4, 5, 6}}, {"cone", {7, 8, 9}}, {"lamp", {10, 11, 12}}};
  edits.materials["paint"].diffuse = glm::vec3(0.1f, 0.2f, 0.3f);
  edits.materials["paint"].exponent = 77.5f;
  edits.materials["room/grey"].diffuse = glm::vec3(0.3f, 0.6f, 0.2f);  // of the model's file alone
  edits.media["fog"] = {glm::vec3(0.1f, 0.2f, 0.4f), glm::vec3(0.9f), 0.5f};
  edits.cameras["main"] = {glm::dvec3(0.1, 0.0, 0.8), {}, 0.5};
  edits.environment = glm::vec3(0.25f, 0.5f, 1.0f);
  std::string text;
  const Scene read = writtenAndRead(scene, edits, &text);
  CHECK(contains(text, "# a remark that stays"));
  REQUIRE(read.lights.size() == 3);
  CHECK(read.lights[0].power == glm::vec3(1, 2, 3));
  CHECK(read.lights[1].power == glm::vec3(4, 5, 6));
  CHECK(read.lights[2].power == glm::vec3(7, 8, 9));
  CHECK(materialOf(read, "box/walls").emission == glm::vec3(10, 11, 12));
  CHECK(materialOf(read, "box/walls").diffuse == glm::vec3(0.1f, 0.2f, 0.3f));
  CHECK(materialOf(read, "box/walls").specular == glm::vec3(0.2f));
  CHECK(materialOf(read, "box/walls").exponent == 77.5f);
  CHECK(materialOf(read, "room/walls").diffuse == glm::vec3(0.3f, 0.6f, 0.2f));
  CHECK(read.media[0].extinction == glm::vec3(0.1f, 0.2f, 0.4f));
  CHECK(read.media[0].albedo == glm::vec3(0.9f));
  CHECK(read.media[0].anisotropy == 0.5f);
  CHECK(read.camera("main").eye == glm::dvec3(0.1, 0.0, 0.8));
  CHECK(read.camera("main").target == glm::dvec3(0, 0, -1));
  CHECK(read.camera("main").fov == 0.5);
  CHECK(read.environment == glm::vec3(0.25f, 0.5f, 1.0f));
  // What is written and not edited is the text itself.
  CHECK(textWithEdits(scene, {}, nullptr, {}) == dsl::format(dsl::parse(kEverything, "all.scene")));
}

TEST_CASE("what is switched off is not in the text that is written, and what shone on it is not either") {
  const Workplace place;
  place.write("all.scene", kEverything);
  const Scene scene = loadScene(place.file("all.scene"));
  const std::vector<std::string> parts = partsOf(scene);
  for (const char* part :
       {"environment", "gloss", "light bulb", "light lamp", "medium fog", "object box/walls"}) {
    INFO(part);
    CHECK(std::find(parts.begin(), parts.end(), part) != parts.end());
  }
  const Scene dark = writtenAndRead(scene, [] {
    SceneEdits edits;
    edits.off = {"environment", "gloss", "light bulb", "light sun", "light lamp", "medium fog"};
    return edits;
  }());
  const SceneTraits traits = SceneTraits::of(dark);
  CHECK_FALSE((traits.environment || traits.glossy || traits.emission || traits.medium));
  REQUIRE(dark.lights.size() == 1);
  CHECK(dark.lights[0].name == "cone");
  SceneEdits without;
  without.off = {"object box/walls"};
  std::string text;
  CHECK(writtenAndRead(scene, without, &text).objects.size() == 1);
  CHECK_FALSE(contains(text, "lamp"));
}

TEST_CASE("lights and cameras that move stay as they move when the scene's text is written") {
  const Workplace place;
  std::string text = kEverything;
  text.insert(text.rfind('}'),
              "  animate bulb { interpolation step\n    key { time 1 s  intensity 0 } }\n"
              "  animate sun { rotate 0 0 1 15 deg/s }\n"
              "  animate main { rotate 0 1 0 10 deg/s  about 0 0 0 }\n");
  place.write("moving.scene", text);
  const Scene scene = loadScene(place.file("moving.scene"));
  SceneEdits edits;
  edits.powers = {{"sun", {4, 5, 6}}};
  const Scene read = writtenAndRead(scene, edits);
  REQUIRE(read.lights.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(read.lights[i].motion == scene.lights[i].motion);
  CHECK(read.lights[1].power == glm::vec3(4, 5, 6));
  CHECK(read.cameras[0].motion == scene.cameras[0].motion);

  edits.off = {"light bulb"};
  std::string written;
  CHECK(writtenAndRead(scene, edits, &written).lights.size() == 2);
  CHECK_FALSE(contains(written, "bulb"));

  SceneEdits bulb;
  bulb.powers = {{"bulb", {1, 1, 1}}};
  CHECK_THROWS_WITH(edited(scene, bulb), Catch::Contains("bulb") && Catch::Contains("keys"));
  SceneEdits moved;
  moved.cameras["main"].eye = glm::dvec3(0, 0, 0.8);
  CHECK_THROWS_WITH(edited(scene, moved), Catch::Contains("main") && Catch::Contains("moves"));

  // A view that is made the first camera stands where the moving camera stood at that time.
  ViewState state;
  state.camera = "main";
  state.time = 9.0;
  const Camera here = cameraOf(state, scene);
  CHECK(glm::distance(here.eye, glm::dvec3(0.9, 0, 0)) < 1e-9);
  CHECK_FALSE((here.motion || !here.keys.empty()));
}

TEST_CASE("an edit that no scene may have, or that the text cannot say, is refused with its reason") {
  const Workplace place;
  place.write("all.scene", kEverything);
  const Scene scene = loadScene(place.file("all.scene"));
  SceneEdits bright;
  bright.materials["paint"].diffuse = glm::vec3(0.9f);
  CHECK_THROWS_WITH(edited(scene, bright), Catch::Contains("paint") && Catch::Contains("at most 1"));
  SceneEdits moved;
  moved.cameras["path"].eye = glm::dvec3(0, 0, 1);
  CHECK_THROWS_WITH(edited(scene, moved), Catch::Contains("path") && Catch::Contains("keys"));
  SceneEdits nowhere;
  nowhere.cameras["main"].eye = glm::dvec3(0, 0, -1);
  CHECK_THROWS_WITH(edited(scene, nowhere), Catch::Contains("same point"));
  place.write("lights.part", "light bulb point { position 0 0.5 0  intensity 1 }\n");
  place.write("includes.scene",
              "scene \"Includes\" {\n  camera main { eye 0 0 0.9  target 0 0 -1 }\n"
              "  mesh room { file \"room.obj\" }\n  include \"lights.part\"\n}\n");
  SceneEdits elsewhere;
  elsewhere.powers["bulb"] = glm::vec3(2);
  CHECK_THROWS_WITH(textWithEdits(loadScene(place.file("includes.scene")), elsewhere, nullptr, {}),
                    Catch::Contains("light bulb") && Catch::Contains("includes.scene"));
}

TEST_CASE("each change of the scene is undone by itself, and one movement of a hand is one change") {
  const Workplace place;
  place.write("all.scene", kEverything);
  const auto session = sessionOf(place.file("all.scene"), "direct_lighting");
  const auto edits = [&] { return session->state().edits; };
  session->perform(
      "light \"bulb\" { power 2 }\nmaterial \"paint\" { diffuse 0.25 }\n"
      "medium \"fog\" { extinction 1 /m }\ncamera \"main\" { fov 50 deg }\n");
  INFO(session->message());
  CHECK(edits().powers.size() + edits().materials.size() + edits().media.size() + edits().cameras.size() ==
        4);
  CHECK(session->shownScene().camera("main").fov == Approx(50.0 * 3.14159265358979 / 180.0));
  session->perform("undo 1");
  CHECK(edits().cameras.empty());
  CHECK(session->shownScene().camera("main").fov == Approx(70.0 * 3.14159265358979 / 180.0));
  session->perform("undo 2");
  CHECK(edits().powers.at("bulb") == glm::vec3(2));
  CHECK(edits().materials.empty());
  session->perform("redo 1");
  CHECK(edits().materials.at("paint").diffuse == glm::vec3(0.25f));
  const std::size_t before = session->undoable();
  for (const char* power : {"3", "4", "5"}) {
    session->perform(std::string("light \"bulb\" { power ") + power + " }");
    session->joinChanges(true);
  }
  session->joinChanges(false);
  CHECK(session->undoable() == before + 1);
  session->perform("undo 1");
  CHECK(edits().powers.at("bulb") == glm::vec3(2));
  session->perform("reset \"light bulb\"");
  CHECK(edits().powers.empty());
  session->perform("reset scene");
  CHECK(edits().empty());
  session->perform("light \"bulbb\" { power 2 }");
  CHECK(contains(session->message(), "did you mean 'bulb'"));
  session->perform("material \"paint\" { diffuse 0.9 }");  // and 0.2 specular
  CHECK(contains(session->message(), "at most 1"));
  CHECK(edits().empty());
}

TEST_CASE("a parameter tells its range, its choices, its default and what was published") {
  const Workplace place;
  const auto session = sessionOf(place.scene(), "implicit_visibility");
  const Row published = rowOf(panelsOf(*session), "change", "as_published");
  CHECK(published.choices == std::vector<std::string>{"off", "on"});
  REQUIRE(published.resets.size() == 1);
  CHECK(published.resets[0].word == "published");
  CHECK_FALSE(published.changed);
  session->perform(published.resets[0].statement);
  const Row on = rowOf(panelsOf(*session), "change", "as_published");
  CHECK(on.value == "on");
  CHECK(on.changed);
  REQUIRE(on.resets.size() == 1);
  CHECK(on.resets[0].word == "default");
  session->perform(on.resets[0].statement);
  CHECK(rowOf(panelsOf(*session), "change", "as_published").value == "off");
}

TEST_CASE("what is edited in the window is asked for before it overwrites a text, and the text repeats it") {
  if (!canShowWindows()) return;
  const Workplace place;
  const std::string before = place.read("room.scene");
  showed(place,
         "light \"bulb\" { power 2 1 0.5 }\n material \"room/grey\" { diffuse 0.3 0.6 0.2 }\n"
         "camera \"main\" { eye 0.1 0 0.8 }\n wait frame\n save_image 'edited.exr'\n panel keep\n"
         " click \"keep/save_scene\"\n record 'asked.json'\n answer no\n record 'refused.json'\n"
         " save_scene 'room.scene'\n click \"question/yes\"\n wait frame\n save_image 'after.exr'\n"
         " record 'after.json'\n quit on",
         committedPipeline("reflective_shadow_maps"));
  CHECK(contains(recordOf(place, "asked.json").at("question"), "Overwrite"));
  CHECK(contains(recordOf(place, "refused.json").at("message"), "stays as it was"));
  const Json after = recordOf(place, "after.json");
  CHECK(after.at("question") == "");
  CHECK(after.at("problem") == "");
  for (const Json& row : after.at("panels").at("scene")) {
    INFO(row.dump());
    CHECK_FALSE(row.value("changed", false));
  }
  for (const Json& row : after.at("panels").at("change"))
    if (row.at("kind") == "number" || row.at("kind") == "choice") {
      INFO(row.dump());
      CHECK(contains(row.value("tooltip", ""), "default "));
    }
  CHECK(place.read("room.scene") != before);
  const CommandResult rendered = ran("render", place.scene(), committedPipeline("reflective_shadow_maps"),
                                     "--resolution 24x16 -o", place.file("rendered.exr"));
  checkSamePixels(place.file("edited.exr"), place.file("rendered.exr"));
  checkSamePixels(place.file("edited.exr"), place.file("after.exr"));
}

TEST_CASE("a script that leaves a question open ends at its place, and nothing is overwritten") {
  if (!canShowWindows()) return;
  const Workplace place;
  const std::string before = place.read("room.scene");
  const CommandResult done =
      shown(place, "light \"bulb\" { power 2 }\n save_scene \"" + place.scene() + "\"\n quit on",
            committedPipeline("direct_lighting"));
  CHECK(done.exitCode != 0);
  CHECK(contains(unwrapped(done.errors), "script.view:4"));
  CHECK(contains(unwrapped(done.errors), "answer yes"));
  CHECK(place.read("room.scene") == before);
}
