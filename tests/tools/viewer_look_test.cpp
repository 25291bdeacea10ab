// What the window shows of ports, times and broken pixels, and what it keeps by other programs.
#include <algorithm>
#include <cstdlib>

#include "lumivox/results/store.h"
#include "tools/started.h"
#include "tools/viewer_support.h"
#include "viewer/arrangement.h"
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
  showed(place,
         "reference off\n set { resolution 8 }\n wait frame\n record 'first.json'\n"
         " port \"voxels.fragments\"\n voxels occupancy\n work on\n wait frame\n record 'voxels.json'\n"
         " tone false_colour\n wait frame\n record 'false.json'\n voxels albedo\n wait problem\n"
         " record 'wrong.json'\n port nothing\n work off\n wait mended\n frame \"all\"\n time 3\n"
         " loop 0.5 s\n play on\n play off\n wait frame\n record 'framed.json'\n quit on",
         committedPipeline("voxel_cone_tracing"));
  const auto record = [&](const char* name) { return recordOf(place, name); };
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
  place.write("nan.pipeline",
              "pipeline \"No number\" {\n  pass paint hostile.paint { deed nan }\n\n"
              "  output direct paint.radiance\n}\n");
  showedWhile(place,
              "--techniques '" + Place::techniques() + "' '" + place.scene() + "' '" +
                  place.file("nan.pipeline") + "' --resolution 8x8",
              "reference off\n wait frame\n record 'nan.json'\n quit on", {});
  CHECK(rowOf(recordOf(place, "nan.json"), "look", "bad_pixels") == "1");
}

TEST_CASE("a grid that is shown is exported, and a point is measured into a store as sweeps do") {
  if (!canShowWindows()) return;
  const Workplace place;
  const CommandResult done = shown(
      place,
      "reference off\n samples 4\n set { resolution 8 }\n port \"grid.mips\"\n level 1\n move 0 0 -0.1\n"
      " export_grid 'grid.vdb'\n wait kept\n record 'exported.json'\n camera main\n"
      " add_point 'points.sqlite'\n wait kept\n export_grid 'grid.obj'\n quit on",
      committedPipeline("voxel_cone_tracing"), "--resolution 8x8");
  INFO(done.errors);
  CHECK(done.exitCode != 0);  // by the last statement alone
  CHECK(contains(done.errors, "grid.obj': expected a name that ends in .vdb"));
  CHECK(contains(recordOf(place, "exported.json").at("message"), "grid.vdb written"));
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
  const Picture voxels = pictureOf(ImageBuffer(2, 1, 3, 1.0f), {0.0, Curve::srgb}),
                behind = pictureOf(ImageBuffer(2, 1, 3, 0.0f), {});
  ImageBuffer brightness(2, 1, 1);
  brightness.at(0, 0, 0) = 0.5f;
  const Picture over = overlaid(voxels, brightness, behind, 0.0),
                half = overlaid(voxels, brightness, behind, 0.5);
  CHECK(over.bytes[0] == 128);
  CHECK(over.bytes[3] == 0);
  CHECK(half.bytes[0] == 64);
}

TEST_CASE("the window judges by FLIP first, and says in words which number there is none of") {
  if (!canShowWindows()) return;
  const Workplace place;
  showed(place,
         "wait frame\n wait reference 8\n wait judged\n wait frame\n record 'lit.json'\n"
         " off \"light bulb\"\n wait frame\n wait reference 8\n wait judged\n record 'dark.json'\n quit on",
         committedPipeline("reflective_shadow_maps"));
  const Json lit = recordOf(place, "lit.json"), dark = recordOf(place, "dark.json");
  std::vector<std::string> order;
  Json chart;
  for (const Json& row : lit.at("panels").at("judge")) {
    const std::string name = row.at("name");
    if (name == "whole image flip" || name == "whole image rmse") order.push_back(name);
    if (name == "tried") chart = row;
  }
  CHECK(order == std::vector<std::string>{"whole image flip", "whole image rmse"});
  REQUIRE(chart.at("marks").size() == 1);
  CHECK(contains(chart.at("label"), "FLIP"));
  CHECK(chart.at("marks")[0].at("y").get<double>() ==
        Approx(std::stod(rowOf(lit, "judge", "whole image flip"))).epsilon(1e-3));
  CHECK(std::stod(rowOf(lit, "judge", "whole image of nothing")) < 1.0);
  CHECK(rowOf(dark, "judge", "whole image mean ratio") == "none: the reference is black");
  CHECK(!contains(dark.at("panels").at("judge").dump(), "nan"));
}

TEST_CASE("an error map has a legend in its own colours, also beside pictures in false colour") {
  const ImageBuffer made(2, 1, 3, 0.5f), reference(2, 1, 3, 1.0f);
  const Picture relative = errorPicture(made, reference, ErrorMap::relative);
  REQUIRE(relative.legends.size() == 1);
  const std::vector<unsigned char>& ramp = relative.legends[0].ramp;
  REQUIRE(ramp.size() > 6);
  CHECK(std::vector(ramp.begin(), ramp.begin() + 3) == std::vector<unsigned char>{0, 0, 255});
  CHECK(std::vector(ramp.end() - 3, ramp.end()) == std::vector<unsigned char>{255, 0, 0});
  for (const ErrorMap map : {ErrorMap::flip, ErrorMap::squared}) {
    const Picture error = errorPicture(made, reference, map);
    REQUIRE(error.legends.size() == 1);
    CHECK(!error.legends[0].ramp.empty());
    CHECK(error.legends[0].ramp != ramp);
  }
  const Picture colours = pictureOf(made, {0.0, Curve::falseColour});
  const Picture all = besides(besides(colours, colours), relative);
  REQUIRE(all.legends.size() == 2);
  CHECK(all.legends[0].text == colours.legends[0].text);
  CHECK(all.legends[1].text == relative.legends[0].text);
}

TEST_CASE("an axis has round numbers, two at least and never many") {
  CHECK(roundNumbers(0.5, 2000.0) == std::vector{1.0, 10.0, 100.0, 1000.0});
  CHECK(roundNumbers(0.9, 40.0) == std::vector{1.0, 3.0, 10.0, 30.0});
  CHECK(roundNumbers(0.19, 1.1) == std::vector{0.2, 0.5, 1.0});
  for (double low = 0.011; low < 20.0; low *= 1.03)
    for (const double factor : {2.25, 5.0, 20.0, 90.0}) {
      INFO(low << " " << factor);
      const std::size_t count = roundNumbers(low, factor * low).size();
      CHECK(count >= 2);
      CHECK(count <= 8);
    }
}

TEST_CASE("pictures side by side take the whole width where that makes them larger, with the panels below") {
  const std::optional<float> three = heightAbovePanels({960, 600, 420, 50}, 3.0f);
  REQUIRE(three);
  CHECK(*three == Approx(0.6f * 600.0f));  // at most
  CHECK(heightAbovePanels({960, 1000, 420, 50}, 3.0f).value_or(0.0f) == Approx(370.0f));
  CHECK(!heightAbovePanels({960, 600, 420, 50}, 1.0f));
  CHECK(!heightAbovePanels({1920, 600, 420, 50}, 3.0f));
}
