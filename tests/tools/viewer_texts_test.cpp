// Texts that somebody changes beside the window: taken as a whole or not at all, and no edit is lost by it.
#include "lumivox/base/error.h"
#include "tools/started.h"
#include "tools/viewer_support.h"
#include "viewer/panels.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::viewer;

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

/// The texts are looked at every quarter of a second.
void look(Session& session) {
  session.step(1.0);
}

/// Two cameras and two lights.
std::string twice(const Workplace& place) {
  return replaced(place.read("room.scene"), "  light bulb",
                  "  camera second { eye 0 0 -0.9  target 0 0 1 }\n"
                  "  light lamp point { position 0 -0.5 0  intensity 2 }\n  light bulb");
}

}  // namespace

TEST_CASE("a camera that is renamed while somebody looks through it gives way to the first, and edits stay") {
  const Workplace place;
  const std::string text = twice(place);
  place.write("room.scene", text);
  const auto session = sessionOf(place.scene(), "direct_lighting");
  session->perform("camera second\nlight \"bulb\" { power 2 }\ncamera \"second\" { fov 50 deg }");
  REQUIRE(session->state().camera == "second");
  place.write("room.scene", replaced(text, "camera second", "camera renamed"));
  look(*session);
  CHECK(session->problem() == "");
  CHECK(session->state().camera == "main");
  CHECK(session->scene().cameras.size() == 2);
  CHECK(
      contains(session->message(), "no longer has the camera 'second': its first, 'main', takes its place"));
  CHECK(contains(session->message(), "no longer in the text: camera second"));
  CHECK(session->state().edits.powers.at("bulb") == glm::vec3(2));
  CHECK(session->undoable() == 2);
  CHECK_NOTHROW(panelsOf(*session));
  session->perform("undo 1\nlight \"lamp\" { power 3 }\nmove 0.1 0 0");
  INFO(session->message());
  CHECK_FALSE(session->messageIsError());
  CHECK(session->state().edits.powers.size() == 2);
  look(*session);
  CHECK(session->problem() == "");
}

TEST_CASE("the window goes on, with its edits, when the camera that it looks through is renamed") {
  if (!canShowWindows()) return;
  const Workplace place;
  const std::string text = place.read("room.scene");
  const auto renamedTo = [&](const char* head) {
    return [&place, text = replaced(text, "camera main {", head)] { place.write("room.scene", text); };
  };
  showedWhile(
      place, "'" + place.scene() + "' '" + committedPipeline("direct_lighting") + "' --resolution 8x8",
      "wait frame\n light \"bulb\" { power 2 }\n wait frame\n record 'first.json'\n wait problem\n"
      " record 'broken.json'\n wait mended\n wait frame\n record 'renamed.json'\n quit on",
      {{"first.json", renamedTo("camera front { what")}, {"broken.json", renamedTo("camera front {")}});
  const Json renamed = recordOf(place, "renamed.json");
  CHECK(renamed.at("problem") == "");
  CHECK(rowOf(renamed, "look", "camera") == "front");
  CHECK_THAT(renamed.at("message").get<std::string>(), Tells("no longer", "camera", "main"));
  CHECK(contains(renamed.at("panels").at("scene").dump(), "\"changed\":true"));
}

TEST_CASE("of texts of which one is wrong none is taken, and all of them when it is mended") {
  const Workplace place;
  place.write("own.pipeline", readFile(committedPipeline("reflective_shadow_maps")));
  const std::string scene = place.read("room.scene"), pipeline = place.read("own.pipeline");
  const auto session = sessionOf(place.scene(), place.file("own.pipeline"));
  session->perform("set { samples 50 }\nlight \"bulb\" { power 2 }");
  INFO(session->message());
  const auto sceneBefore = session->scene().hash, shownBefore = session->shownScene().hash;
  place.write("room.scene", replaced(scene, "camera main", "camera front"));
  place.write("own.pipeline", "pipeline \"Broken\" {\n  pass gbuffer direct_lighting.gbufer { \n}\n");
  look(*session);
  CHECK(contains(session->problem(), "own.pipeline:"));
  CHECK(session->scene().hash == sceneBefore);
  CHECK(session->shownScene().hash == shownBefore);
  CHECK(session->state().camera == "main");
  CHECK(session->state().sides.front().values.at("samples").number == 50.0);
  session->perform("move 0.1 0 0\nlight \"bulb\" { power 3 }\ncamera main");
  CHECK_FALSE(session->messageIsError());
  place.write("own.pipeline", pipeline + "# mended\n");
  look(*session);
  CHECK(session->problem() == "");
  CHECK(session->state().camera == "front");
  CHECK_FALSE(session->scene().hash == sceneBefore);
  CHECK(session->state().edits.powers.at("bulb") == glm::vec3(3));
  CHECK(session->state().sides.front().values.at("samples").number == 50.0);
  CHECK(session->state().sides.front().pipeline == session->pipelines().front());
}

TEST_CASE(
    "a text that edits do not fit waits until they are taken back, and undoing fits the text that there is") {
  const Workplace place;
  const std::string text =
      replaced(place.read("room.scene"), "  light bulb",
               "  material paint { diffuse 0.2  specular 0.1  exponent 9 }\n"
               "  mesh box { file \"room.obj\"  material paint  scale 0.2 }\n  light bulb");
  place.write("room.scene", text);
  const auto session = sessionOf(place.scene(), "direct_lighting");
  session->perform("material \"paint\" { diffuse 0.8 }");
  REQUIRE_FALSE(session->messageIsError());
  const auto before = session->scene().hash;
  place.write("room.scene", replaced(text, "specular 0.1", "specular 0.6"));
  look(*session);
  CHECK(contains(session->problem(), "material 'paint' reflects more light than it receives"));
  CHECK(session->scene().hash == before);
  session->perform("undo 1");
  look(*session);
  CHECK(session->problem() == "");
  CHECK_FALSE(session->scene().hash == before);
  // What was undone fits the new text no more: nothing is done, and nothing is lost.
  session->perform("redo 1");
  CHECK(session->messageIsError());
  CHECK(contains(session->message(), "at most 1"));
  CHECK(session->redoable() == 1);
  CHECK(session->undoable() == 0);
  CHECK(session->state().edits.empty());
}

TEST_CASE(
    "an output or a value of a parameter that a changed pipeline has no longer is given up with a word") {
  const Workplace place;
  place.write("own.pipeline", readFile(committedPipeline("reflective_shadow_maps")));
  const std::string pipeline = place.read("own.pipeline");
  const auto session = sessionOf(place.scene(), place.file("own.pipeline"));
  session->perform("set { samples 50 }\noutput indirect_diffuse");
  REQUIRE_FALSE(session->messageIsError());
  place.write("own.pipeline", "pipeline \"Other\" {\n" +
                                  readFile(committedPipeline("direct_lighting"))
                                      .substr(readFile(committedPipeline("direct_lighting")).find('{') + 1));
  look(*session);
  INFO(session->message());
  CHECK(session->problem() == "");
  CHECK(contains(session->message(), "own.pipeline: not all that was set fits the changed text"));
  CHECK(
      contains(session->message(), "no longer has the output 'indirect_diffuse': the whole image is shown"));
  CHECK(session->state().sides.front().values.empty());
  CHECK(session->state().output == viewer::kWholeImage);
  // Undoing does not bring a text back that is gone.
  session->perform("undo 1");
  CHECK(session->state().sides.front().pipeline == session->pipelines().front());
}

TEST_CASE("a refused statement of a panel is told in the window, which goes on") {
  if (!canShowWindows()) return;
  const Workplace place;
  showed(place,
         "wait frame\n light \"bulb\" { power 2 }\n panel keep\n click \"keep/copy_command\"\n wait frame\n"
         " record 'told.json'\n quit on",
         committedPipeline("direct_lighting"), "--resolution 8x8");
  REQUIRE(place.has("told.json"));
  CHECK(contains(recordOf(place, "told.json").at("message"), "no command: the texts do not say"));
}
