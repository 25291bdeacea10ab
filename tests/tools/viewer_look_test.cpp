// What the window shows of ports, times and broken pixels, and what it keeps by other programs.
#include <algorithm>
#include <cstdlib>

#include "lumivox/results/store.h"
#include "tools/started.h"
#include "tools/viewer_support.h"
#include "viewer/picture.h"
#include "viewer/program.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::viewer;

namespace {

std::size_t marksOf(const Json& record, const std::string& panel, const std::string& row) {
  for (const Json& one : record.at("panels").at(panel))
    if (one.at("name") == row) return one.contains("marks") ? one.at("marks").size() : 0;
  return 0;
}

}  // namespace

TEST_CASE("voxels of a port are shown in the window, with times of its frames and bytes of its ports") {
  if (!canShowWindows()) return;
  const Workplace place;
  const CommandResult done = shown(
      place,
      "reference off\n set { resolution 8 }\n wait frame\n record " + quotedFile(place, "first.json") +
          "\n port \"voxels.fragments\"\n voxels occupancy\n work on\n wait frame\n record " +
          quotedFile(place, "voxels.json") + "\n tone false_colour\n wait frame\n record " +
          quotedFile(place, "false.json") + "\n voxels albedo\n wait problem\n record " +
          quotedFile(place, "wrong.json") +
          "\n port nothing\n work off\n wait mended\n frame \"all\"\n time 3\n loop 0.5 s\n play on\n play off\n wait "
          "frame\n record " +
          quotedFile(place, "framed.json") + "\n quit on",
      committedPipeline("voxel_cone_tracing"));
  INFO(done.errors);
  REQUIRE(done.exitCode == 0);
  const auto record = [&](const char* name) { return Json::parse(place.read(name)); };
  const Json first = record("first.json"), voxels = record("voxels.json");
  CHECK(contains(rowOf(first, "time", "frame"), " ms, "));
  CHECK(contains(rowOf(first, "time", "first_picture"), " s after the start"));
  CHECK(rowOf(first, "time", "port voxels.fragments") == "absent");
  CHECK(voxels.at("problem") == "");
  CHECK(std::stoi(rowOf(voxels, "look", "voxel_pixels")) > 24 * 16 / 4);
  CHECK(contains(rowOf(voxels, "look", "quantity"), "whether a surface touches the voxel"));
  CHECK(contains(rowOf(voxels, "time", "frame"), "kept"));
  CHECK(rowOf(voxels, "time", "port voxels.fragments") != "absent");
  CHECK(rowOf(voxels, "time", "share voxels") != "absent");
  CHECK(marksOf(voxels, "time", "frames") > marksOf(first, "time", "frames"));
  CHECK(rowOf(record("false.json"), "look", "legend") == "value 0 to 1");
  const std::string problem = record("wrong.json").at("problem");
  CHECK(contains(problem, "voxels albedo"));
  CHECK(contains(problem, "occupancy, fragments"));
  const Json framed = record("framed.json");
  CHECK(rowOf(framed, "look", "camera") == "free");
  CHECK(std::strtod(rowOf(framed, "look", "time").c_str(), nullptr) < 0.5);
}

TEST_CASE("a pixel that is no number is counted, and flashes as long as it is there") {
  if (!canShowWindows()) return;
  const Place place;
  place.write(
      "nan.pipeline",
      "pipeline \"No number\" {\n  pass paint hostile.paint { deed nan }\n\n  output direct paint.radiance\n}\n");
  place.write("script.view", "view \"a test\" {\n reference off\n wait frame\n record " +
                                 quotedFile(place, "nan.json") + "\n quit on\n}\n");
  const CommandResult done = runCommand(windowCommand(
      "--techniques '" + Place::techniques() + "' '" + place.scene() + "' '" + place.file("nan.pipeline") +
      "' --resolution 8x8 --script '" + place.file("script.view") + "'"));
  INFO(done.errors);
  REQUIRE(done.exitCode == 0);
  CHECK(rowOf(Json::parse(place.read("nan.json")), "look", "bad_pixels") == "1");
}

TEST_CASE("a grid that is shown is exported, and a point is measured into a store as sweeps do") {
  if (!canShowWindows()) return;
  const Workplace place;
  const CommandResult done = shown(
      place,
      "reference off\n samples 4\n set { resolution 8 }\n port \"grid.mips\"\n level 1\n move 0 0 -0.1\n "
      "export_grid " +
          quotedFile(place, "grid.vdb") + "\n wait kept\n record " + quotedFile(place, "exported.json") +
          "\n camera main\n add_point " + quotedFile(place, "points.sqlite") + "\n wait kept\n export_grid " +
          quotedFile(place, "grid.obj") + "\n quit on",
      committedPipeline("voxel_cone_tracing"), "--resolution 8x8");
  INFO(done.errors);
  CHECK(done.exitCode != 0);  // by the last statement alone
  CHECK(contains(done.errors, "grid.obj': expected a name that ends in .vdb"));
  CHECK(contains(Json::parse(place.read("exported.json")).at("message"), "grid.vdb written"));
  const CommandResult listed = runCommand("'" + (binaryDirectory() / "bin/vdbexport").string() +
                                          "' --list '" + place.file("grid.vdb") + "'");
  INFO(listed.errors << listed.output);
  CHECK(listed.exitCode == 0);
  CHECK(contains(listed.output, "radiance"));
  for (const auto& entry : std::filesystem::directory_iterator(place.path()))
    CHECK(entry.path().filename().string().front() != '.');  // texts of the moment are gone
  const std::vector<StoredRun> runs =
      ResultsStore(place.file("points.sqlite"), ResultsStore::Mode::read).runs({});
  REQUIRE(runs.size() == 1);
  CHECK(runs.front().point.failure.empty());
  CHECK(runs.front().point.parameters.at("resolution").number == 8.0);
}

TEST_CASE("a program that is stopped ends, and voxels lie over what is behind them") {
  const std::atomic<bool> stop{true};
  CHECK(runProgram({"/bin/sleep", "30"}, &stop).exitCode != 0);
  const Picture voxels = pictureOf(ImageBuffer(2, 1, 3, 1.0f), {}),
                behind = pictureOf(ImageBuffer(2, 1, 3, 0.0f), {});
  ImageBuffer brightness(2, 1, 1);
  brightness.at(0, 0, 0) = 0.5f;
  const Picture over = overlaid(voxels, brightness, behind, 0.0),
                half = overlaid(voxels, brightness, behind, 0.5);
  CHECK(over.bytes[0] == 128);
  CHECK(over.bytes[3] == 0);
  CHECK(half.bytes[0] == 64);
}
