// The window, driven by scripts on a display of its own, which no one sees.
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "lumivox/base/image.h"
#include "tools/started.h"
#include "tools/viewer_support.h"
#include "viewer/actions.h"
#include "viewer/picture.h"
#include "viewer/reference_worker.h"
#include "viewer/scene_edits.h"
#include "viewer/view_state.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::viewer;
TEST_CASE(
    "a window shows the picture that render makes, to the bit, through a camera of the scene or a free one") {
  if (!canShowWindows()) return;
  const Workplace place;
  showed(place,
         "wait frame\n save_image 'fixed.exr'\n move 0.1 0.05 -0.2\n turn 5 deg -3 deg\n set { samples 2 }\n"
         " wait frame\n save_image 'free.exr'\n copy_command on\n record 'record.json'\n"
         " save_scene 'seen.scene'\n save_pipeline 'set.pipeline'\n off \"light bulb\"\n"
         " record 'edited.json'\n quit on",
         committedPipeline("reflective_shadow_maps"));
  const std::string pipeline = committedPipeline("reflective_shadow_maps");
  ran("render", place.scene(), pipeline, "--resolution 24x16 -o", place.file("rendered.exr"));
  checkSamePixels(place.file("fixed.exr"), place.file("rendered.exr"));
  // The command that the window tells, and the texts that it writes, repeat the other.
  std::string command = rowOf(recordOf(place, "record.json"), "keep", "command");
  REQUIRE(contains(command, "--eye"));
  CHECK(contains(rowOf(recordOf(place, "edited.json"), "keep", "command"), "no command"));
  command.replace(command.find("out/view.exr"), 12, "'" + place.file("told.exr") + "'");
  const CommandResult told = runCommand(command);
  INFO(told.errors);
  REQUIRE(told.exitCode == 0);
  checkSamePixels(place.file("free.exr"), place.file("told.exr"));
  const CommandResult checked = typed("check", place.file("seen.scene"), place.file("set.pipeline"));
  INFO(checked.errors << checked.output);
  CHECK(checked.exitCode == 0);
  ran("render", place.file("seen.scene"), place.file("set.pipeline"), "--camera view -o",
      place.file("written.exr"));
  checkSamePixels(place.file("free.exr"), place.file("written.exr"));
}

TEST_CASE("a parameter that is clicked is the parameter that is written, and undone it is what it was") {
  if (!canShowWindows()) return;
  const Workplace place;
  showed(place,
         "wait frame\n panel change\n click \"change/samples/more\"\n wait frame\n record 'clicked.json'\n"
         " save_image 'clicked.exr'\n key \"ctrl Z\"\n wait frame\n record 'undone.json'\n"
         " set { samples 200 }\n wait frame\n record 'written.json'\n save_image 'written.exr'\n quit on",
         committedPipeline("reflective_shadow_maps"), "--resolution 24x16 --set samples=100");
  CHECK(rowOf(recordOf(place, "clicked.json"), "change", "samples") == "200");
  CHECK(rowOf(recordOf(place, "undone.json"), "change", "samples") == "100");
  CHECK(rowOf(recordOf(place, "written.json"), "change", "samples") == "200");
  checkSamePixels(place.file("clicked.exr"), place.file("written.exr"));
}

TEST_CASE(
    "what is switched off in the scene is left out at once, and the reference converges beside the picture") {
  if (!canShowWindows()) return;
  const Workplace place;
  showed(place,
         "wait frame\n wait reference 8\n wait judged\n record 'on.json'\n panel scene\n"
         " click \"scene/light bulb\"\n wait frame\n record 'off.json'\n window 1 1\n wait frame\n"
         " window 4096 200\n wait frame\n shot 'wide.png'\n quit on",
         committedPipeline("reflective_shadow_maps"));
  const Json on = recordOf(place, "on.json"), off = recordOf(place, "off.json");
  CHECK(on.at("problem") == "");
  CHECK(contains(rowOf(on, "judge", "whole image layer"), "full"));
  CHECK(contains(rowOf(on, "judge", "whole image rmse"), "±"));
  CHECK(std::stoi(rowOf(on, "judge", "samples")) >= 8);
  const auto passes = [](const Json& record) { return std::stoi(rowOf(record, "need", "passes")); };
  CHECK(passes(off) < passes(on));
  CHECK(place.has("wide.png"));
}

TEST_CASE(
    "a text that is broken while it is shown says where, and the picture comes back when it is mended") {
  if (!canShowWindows()) return;
  const Workplace place;
  const std::string good = readFile(committedPipeline("reflective_shadow_maps"));
  place.write("own.pipeline", good);
  showedWhile(
      place, "'" + place.scene() + "' '" + place.file("own.pipeline") + "' --resolution 24x16",
      "wait frame\n record 'first.json'\n wait problem\n record 'broken.json'\n wait mended\n wait frame\n"
      " record 'mended.json'\n quit on",
      {{"first.json",
        [&] {
          place.write("own.pipeline",
                      "pipeline \"Broken\" {\n  pass gbuffer direct_lighting.gbufer { }\n}\n");
        }},
       {"broken.json", [&] {
          std::filesystem::remove(place.file("own.pipeline"));  // gone while it is shown, and back
          std::this_thread::sleep_for(std::chrono::milliseconds(400));
          place.write("own.pipeline", good);
        }}});
  CHECK_THAT(recordOf(place, "broken.json").at("problem").get<std::string>(),
             Tells("own.pipeline:2", "gbuffer"));
  CHECK(recordOf(place, "mended.json").at("problem") == "");
}

TEST_CASE("a shader that is broken while it is shown says its line, and what is mended is swapped in") {
  if (!canShowWindows()) return;
  const Workplace place;
  namespace fs = std::filesystem;
  // A tree of its own: libraries, packs and the shaders of one technique.
  fs::create_directories(place.path() / "lib/techniques");
  fs::create_directories(place.path() / "shaders");
  for (const std::string name : {"direct_lighting", "reflective_shadow_maps"})
    for (const std::string& file : {"lib" + name + ".so", name + ".shaderpack"})
      fs::copy_file(binaryDirectory() / "lib/techniques" / file, place.path() / "lib/techniques" / file);
  for (const std::string folder : {"common", "direct_lighting"})
    fs::copy(sourceDirectory() / "shaders" / folder, place.path() / "shaders" / folder);
  const fs::path shader = place.path() / "shaders/direct_lighting/compose.comp";
  const std::string good = readFile(shader);
  // Half as bright: what is swapped in is seen.
  std::string changed = good;
  const std::size_t store = changed.find("imageStore(");
  REQUIRE(store != std::string::npos);
  const std::size_t end = changed.find(");\n", store), value = changed.find("vec4(", store);
  changed.insert(end, ")").insert(value, "(0.5 * ");
  const auto write = [&](const std::string& text) {
    return [&place, text] { place.write("shaders/direct_lighting/compose.comp", text); };
  };
  showedWhile(place,
              "--techniques '" + place.file("lib/techniques") + "' '" + place.scene() + "' '" +
                  committedPipeline("reflective_shadow_maps") + "' --resolution 24x16",
              "wait frame\n save_image 'first.exr'\n wait problem\n record 'broken.json'\n wait mended\n"
              " wait frame\n save_image 'mended.exr'\n quit on",
              {{"first.exr", write(good + "\nthis is no GLSL\n")}, {"broken.json", write(changed)}});
  CHECK_THAT(recordOf(place, "broken.json").at("problem").get<std::string>(),
             Tells("compose.comp:" + std::to_string(std::count(good.begin(), good.end(), '\n') + 2)));
  const ImageBuffer before = readExr(place.file("first.exr")).layers.at("final"),
                    after = readExr(place.file("mended.exr")).layers.at("final");
  REQUIRE(before.sameShape(after));
  for (std::size_t i = 0; i < before.values().size(); ++i)
    CHECK(after.values()[i] == Approx(0.5f * before.values()[i]).margin(1e-6));
}

TEST_CASE("two hundred random actions leave a window that works") {
  if (!canShowWindows()) return;
  const Workplace place;
  showed(place,
         "seed 7\n wait frame\n random 200\n play off\n beside nothing\n reset \"all\"\n reset scene\n"
         " camera main\nwait frame\n record 'record.json'\n quit on",
         committedPipeline("reflective_shadow_maps"), "--resolution 8x8");
  CHECK(recordOf(place, "record.json").at("settled") == true);
}

TEST_CASE("a technique that throws is told in place, and the window goes on") {
  if (!canShowWindows()) return;
  const Place place;
  place.write("refuse.pipeline",
              "pipeline \"Refuse\" {\n  pass paint hostile.paint { deed refuse }\n\n"
              "  output direct paint.radiance\n}\n");
  showedWhile(
      place,
      "--techniques '" + Place::techniques() + "' '" + place.scene() + "' '" + place.file("refuse.pipeline") +
          "' '" + place.file("fast.pipeline") + "' --resolution 8x8",
      "wait problem\n record 'refused.json'\n show fast\n wait mended\n wait frame\n save_image 'good.exr'\n"
      " quit on",
      {});
  CHECK(contains(recordOf(place, "refused.json").at("problem"), "the pass refuses"));
  CHECK(place.has("good.exr"));
}

TEST_CASE("without a display a sentence says so, and wrong texts open no window") {
  const Workplace place;
  const std::string program =
      "env -u DISPLAY -u WAYLAND_DISPLAY '" + (binaryDirectory() / "bin/lumivox-view").string() + "' ";
  const std::string texts = "'" + place.scene() + "' '" + committedPipeline("direct_lighting") + "'";
  const CommandResult none = runCommand(program + texts);
  CHECK(none.exitCode == 2);
  CHECK(contains(none.errors, "no display"));
  CHECK(contains(none.errors, "lumivox render"));
  place.write("wrong.view", "view \"wrong\" {\n  mvoe 1 0 0\n}\n");
  const CommandResult script = runCommand(program + texts + " --script '" + place.file("wrong.view") + "'");
  CHECK(script.exitCode == 2);
  CHECK(contains(script.errors, "did you mean 'move'"));
  const CommandResult absent = typed("view", place.file("absent.scene"));
  CHECK(absent.exitCode == 2);
  CHECK(unwrapped(absent.errors) ==
        "lumivox-view: " + place.file("absent.scene") + ": cannot read: No such file or directory\n");
}

TEST_CASE("every statement that the window writes into its history is one that it reads") {
  for (const char* text :
       {"move 0.1 0 -2.5", "turn 0.01 rad -0.02 rad", "set { resolution 32 }", "set gather { cones 6 }",
        "off \"light bulb\"", "exposure auto", "exposure 1.5", "port \"voxels.fragments\"",
        "light \"the bulb\" { power 1 2 3 }", "layout side_by_side", "wait reference 64"}) {
    INFO(text);
    const std::vector<Action> actions = parseActions(text);
    REQUIRE(actions.size() == 1);
    CHECK(parseActions(actions.front().written()).front().written() == actions.front().written());
  }
  for (const char* choice : {"split", "whole image", "voxels.fragments"})
    CHECK(parseActions("output " + choiceValue(choice)).front().text() == choice);
  CHECK_THROWS_WITH(parseActions("layout sideways"), Catch::Contains("sideways"));
}

TEST_CASE("a camera turns about its eye, orbits its target, and never goes over the pole") {
  Camera camera;
  camera.eye = {0, 0, 2};
  camera.target = {0, 0, 0};
  camera.up = {0, 1, 0};
  const double quarter = 0.5 * 3.14159265358979323846;
  const Camera right = turned(camera, quarter, 0.0);
  CHECK(right.eye == camera.eye);
  CHECK(glm::length(right.target - glm::dvec3(2, 0, 2)) == Approx(0.0).margin(1e-12));
  const Camera around = orbited(camera, quarter, 0.0);
  CHECK(around.target == camera.target);
  CHECK(glm::length(around.eye - glm::dvec3(2, 0, 0)) == Approx(0.0).margin(1e-12));
  const Camera up = turned(camera, 0.0, 10.0);
  CHECK(glm::normalize(up.target - up.eye).y < 1.0);
  CHECK(glm::normalize(up.target - up.eye).y > 0.999);
  CHECK(glm::length(zoomed(camera, 0.5).eye) == Approx(1.0));
  CHECK(moved(camera, {0, 0, 1}).eye == glm::dvec3(0, 0, 1));
}

TEST_CASE("rounds of a reference add up to their mean, and variances as those of means do") {
  LayeredImage mean, round;
  mean.layers["full"] = ImageBuffer(1, 1, 1, 1.0f);
  mean.layers["full.variance"] = ImageBuffer(1, 1, 1, 0.4f);
  round.layers["full"] = ImageBuffer(1, 1, 1, 5.0f);
  round.layers["full.variance"] = ImageBuffer(1, 1, 1, 0.8f);
  addRound(mean, 6, round, 2);
  CHECK(mean.layers.at("full").at(0, 0, 0) == Approx(2.0));
  CHECK(mean.layers.at("full.variance").at(0, 0, 0) == Approx(0.4 * 9.0 / 16.0 + 0.8 / 16.0));
}

TEST_CASE("pictures mark what is no number, tell the sign of errors, and split where they are told") {
  ImageBuffer image(2, 1, 3, 0.5f);
  image.at(1, 0, 1) = std::numeric_limits<float>::quiet_NaN();
  const Picture marked = pictureOf(image, {});
  CHECK(marked.badPixels == 1);
  CHECK(marked.bytes[3] == 255);
  CHECK(marked.bytes[4] == 0);
  CHECK(marked.bytes[5] == 255);
  CHECK(pictureOf(image, {0.0, Curve::srgb, false}).bytes[3] == 0);
  ImageBuffer reference(2, 1, 3, 1.0f), made(2, 1, 3, 1.0f);
  for (int c = 0; c < 3; ++c) made.at(0, 0, c) = 0.5f, made.at(1, 0, c) = 1.5f;
  const Picture error = errorPicture(made, reference, ErrorMap::relative);
  CHECK(error.bytes[0] == 0);
  CHECK(error.bytes[2] > 150);  // too dark: blue
  CHECK(error.bytes[3] > 150);  // too bright: red
  CHECK(error.bytes[5] == 0);
  const Picture dark = pictureOf(ImageBuffer(4, 1, 3, 0.0f), {}),
                bright = pictureOf(ImageBuffer(4, 1, 3, 1.0f), {0.0, Curve::srgb});
  const Picture split = splitPicture(dark, bright, 0.5);
  CHECK(split.bytes[0] == 0);
  CHECK(split.bytes[9] == 255);
}

TEST_CASE("a scene without an object keeps the triangles of the others where they were") {
  const Workplace place;
  place.write(
      "two.scene",
      "scene \"Two rooms\" {\n  camera main { eye 0 0 0.9  target 0 0 -1 }\n  mesh room { file \"room.obj\" }\n"
      "  mesh other { file \"room.obj\" }\n  light bulb point { position 0 0.5 0  intensity 1 1 1 }\n}\n");
  const Scene scene = loadScene(place.file("two.scene"));
  REQUIRE(scene.objects.size() == 2);
  SceneEdits edits;
  edits.off.insert("object " + scene.objects[0].name);
  const Scene less = edited(scene, edits);
  REQUIRE(less.objects.size() == 1);
  CHECK(less.triangleCount() == scene.triangleCount() / 2);
  for (std::size_t i = 0; i < less.indices.size(); ++i) {
    const std::uint32_t before = scene.indices[scene.objects[1].parts[0].firstIndex + i];
    CHECK(less.positions[less.indices[i]] == scene.positions[before]);
  }
  CHECK(!(less.hash == scene.hash));
  edits.off = {"light bulb"};
  CHECK(edited(scene, edits).lights.empty());
}
