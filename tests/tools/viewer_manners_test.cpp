// How the window behaves: sizes, monitors, layouts, ends, and what is broken around it while it shows.
#include <algorithm>
#include <chrono>
#include <thread>

#include "lumivox/base/file.h"
#include "tools/started.h"
#include "tools/viewer_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

namespace fs = std::filesystem;

/// Width and height, from the header of the file.
std::pair<int, int> sizeOfPng(const std::string& bytes) {
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = 256 * value + static_cast<unsigned char>(bytes.at(at + i));
    return value;
  };
  return {number(16), number(20)};
}

}  // namespace

TEST_CASE("a window of any size, put away and brought back, and on a monitor of another density goes on") {
  if (!canShowWindows()) return;
  const Workplace place;
  showed(place,
         "window 1 1\n wait frame\n move 0.1 0 0\n wait frame\n window 4096 200\n wait frame\n minimise on\n"
         "move 0 0.1 0\n wait frame\n minimise off\n window 800 600\n scale 2.5\n shot 'dense.png'\n"
         " scale 1\n shot 'plain.png'\n panels off\n shot 'alone.png'\n panels on\n record 'record.json'\n"
         " quit on",
         committedPipeline("direct_lighting"));
  const Json record = recordOf(place, "record.json");
  CHECK(record.at("problem") == "");
  CHECK(record.at("settled") == true);
  const std::string dense = place.read("dense.png"), plain = place.read("plain.png");
  CHECK(sizeOfPng(plain) == std::pair(800, 600));
  CHECK(dense != plain);
  CHECK(place.read("alone.png") != plain);
}

TEST_CASE("the keyboard reaches picture, panels and controls") {
  if (!canShowWindows()) return;
  const Workplace place;
  showed(place,
         "wait frame\n key \"[\"\n key \"]\"\n key \"H\"\n key \"H\"\n key \"?\"\n key \"?\"\nkey \"3\"\n"
         " key \"down\"\n key \"press\"\n record 'pressed.json'\n key \"F6\"\n key \"right\"\n key \"W\"\n"
         " wait frame\n record 'turned.json'\n quit on",
         committedPipeline("direct_lighting"));
  const Json pressed = recordOf(place, "pressed.json"), turned = recordOf(place, "turned.json");
  CHECK(rowOf(pressed, "time", "times") == "off");
  CHECK(rowOf(pressed, "look", "camera") == "main");
  CHECK(rowOf(turned, "look", "camera") == "free");
  const std::string history = turned.at("panels").at("keep").dump();
  CHECK(contains(history, "turn "));
  CHECK(contains(history, "move "));
}

TEST_CASE("the layout of a window is that of the last one, and a broken layout is told and passed over") {
  if (!canShowWindows()) return;
  const Workplace place;
  const std::string layout = "--resolution 8x8 --layout '" + place.file("state/layout.view") + "'";
  const std::string pipeline = committedPipeline("direct_lighting");
  showed(place, "window 700 500\n panel time\n panel_width 300\n wait frame\n quit on", pipeline, layout);
  const std::string kept = place.read("state/layout.view");
  CHECK(contains(kept, "window 700 500"));
  CHECK(contains(kept, "panel time"));
  CHECK(contains(kept, "panel_width 300"));
  const CommandResult second = shown(place, "wait frame\n shot 'second.png'\n quit on", pipeline, layout);
  REQUIRE(second.exitCode == 0);
  CHECK(sizeOfPng(place.read("second.png")) == std::pair(700, 500));
  CHECK(place.read("state/layout.view") == kept);
  place.write("state/layout.view", "view \"layout\" {\n  widnow 700 500\n}\n");
  const CommandResult third = showed(place, "record 'third.json'\n quit on", pipeline, layout);
  CHECK(contains(recordOf(place, "third.json").at("message"), "widnow"));
}

TEST_CASE("a window that is closed while a reference is traced ends within a second") {
  if (!canShowWindows()) return;
  const Workplace place;
  // A round of 64 samples of this image takes longer than that on a busy machine.
  const CommandResult done = shown(place, "samples 1048576\n wait reference 2\n record 'last.json'\n quit on",
                                   committedPipeline("direct_lighting"), "--resolution 256x256");
  const auto ended = std::chrono::system_clock::now();
  INFO(done.errors);
  REQUIRE(done.exitCode == 0);
  const auto last = std::chrono::file_clock::to_sys(fs::last_write_time(place.file("last.json")));
  const double seconds = std::chrono::duration<double>(ended - last).count();
  INFO("it took " << seconds << " s");
  // On a machine that may be busy.
  CHECK(seconds < 5.0);
}

TEST_CASE("a scene that is deleted while it is shown is told, and comes back with its file") {
  if (!canShowWindows()) return;
  const Workplace place;
  const std::string text = place.read("room.scene");
  showedWhile(place,
              "'" + place.scene() + "' '" + committedPipeline("direct_lighting") + "' --resolution 8x8",
              "wait frame\n record 'first.json'\n wait problem\n move 0.1 0 0\n record 'gone.json'\n"
              " wait mended\n wait frame\n record 'back.json'\n quit on",
              {{"first.json", [&] { fs::remove(place.file("room.scene")); }},
               {"gone.json", [&] { place.write("room.scene", text); }}});
  CHECK_THAT(recordOf(place, "gone.json").at("problem").get<std::string>(), Tells("room.scene"));
  CHECK(recordOf(place, "back.json").at("problem") == "");
}

TEST_CASE("a technique that throws while it is loaded anew is told, and the one before it goes on") {
  if (!canShowWindows()) return;
  const Workplace place;
  fs::create_directories(place.path() / "techniques");
  const fs::path library = place.path() / "techniques/libhostile.so",
                 good = binaryDirectory() / "tests/plugins/hostile/libhostile.so",
                 bad = binaryDirectory() / "tests/plugins/throwing/libthrowing.so";
  fs::copy_file(good, library);
  place.write("paint.pipeline",
              "pipeline \"Paint\" {\n  pass paint hostile.paint { }\n\n  output direct paint.radiance\n}\n");
  const auto swapIn = [&](const fs::path& from) {
    return [&place, &library, from] {
      fs::copy_file(from, place / "new.so");
      fs::rename(place / "new.so", library);  // as a linker's output is put in place
    };
  };
  showedWhile(place,
              "--techniques '" + place.file("techniques") + "' '" + place.scene() + "' '" +
                  place.file("paint.pipeline") + "' --resolution 8x8",
              "wait frame\n record 'first.json'\n wait problem\n record 'thrown.json'\n wait mended\n"
              " wait frame\n save_image 'back.exr'\n quit on",
              {{"first.json", swapIn(bad)}, {"thrown.json", swapIn(good)}});
  CHECK_THAT(recordOf(place, "thrown.json").at("problem").get<std::string>(), Tells("table of directions"));
  CHECK(place.has("back.exr"));
}

TEST_CASE("the script that makes the pictures of the guide runs, and makes each that the guide shows") {
  if (!canShowWindows()) return;
  const Workplace place;
  const CommandResult done =
      runCommand("cd '" + place.path().string() + "' && " +
                 windowCommand("'" + (sourceDirectory() / "scenes/cornell.scene").string() + "' '" +
                               committedPipeline("reflective_shadow_maps") + "' --resolution 8x8 --script '" +
                               (sourceDirectory() / "docs/viewer_pictures.view").string() + "'"));
  INFO(done.errors);
  REQUIRE(done.exitCode == 0);
  const std::string guide = readFile(sourceDirectory() / "docs/viewer.md");
  int shown = 0;
  for (std::size_t at = guide.find("](images/"); at != std::string::npos;
       at = guide.find("](images/", at + 1)) {
    const std::string name = guide.substr(at + 2, guide.find(')', at) - at - 2);
    INFO(name);
    ++shown;
    CHECK(place.has("docs/" + name));
    CHECK(fs::file_size(sourceDirectory() / "docs" / name) < 60000);
  }
  CHECK(shown == 7);
}
