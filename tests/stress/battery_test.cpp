// The quick stress battery, family by family, and the battery itself on a technique that does what none may
// do.
#include <nlohmann/json.hpp>
#include <set>

#include "lumivox/base/file.h"
#include "lumivox/results/store.h"
#include "support/drawn_page.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

struct Battery {
  CommandResult result;
  Json cells;
};

/// One worker with one thread: ctest runs several tests at a time.
Battery battery(const std::string& arguments) {
  Battery battery{runCommand("LP_NUM_THREADS=1 '" + (binaryDirectory() / "bin/lumivox").string() +
                             "' --quiet stress --workers 1 --json " + arguments),
                  {}};
  INFO("stderr: " << battery.result.errors);
  REQUIRE(battery.result.exitCode < 2);
  battery.cells = Json::parse(battery.result.output);
  return battery;
}

void checkQuickFamily(const std::string& family) {
  const Battery quick = battery("--quick --family " + family);
  REQUIRE(!quick.cells.empty());
  for (const Json& cell : quick.cells) {
    const std::string outcome = cell.at("outcome");
    INFO(cell.at("pipeline") << ", " << cell.at("case") << ": " << outcome << " " << cell.at("value") << "\n"
                             << cell.at("detail") << "\n"
                             << cell.at("command"));
    CHECK(outcome != "broken");
    // A property of the published method is explained where the method is described.
    if (outcome == "biased" || outcome == "diverges") CHECK(cell.at("explanation") != "");
    if (outcome == "refused") CHECK(cell.at("detail") != "");
  }
  CHECK(quick.result.exitCode == 0);
}

/// A pipeline of the technique that does what none may do.
class HostilePlace : public Workplace {
 public:
  HostilePlace() {
    for (const char* deed : {"paint", "abort", "fault", "spin", "nan", "refuse", "exhaust"})
      write(std::string(deed) + ".pipeline", "pipeline \"" + std::string(deed) +
                                                 "\" {\n  pass paint hostile.paint { deed " + deed +
                                                 " }\n\n  output direct paint.radiance\n}\n");
  }
  Battery run(const std::vector<std::string>& deeds, const std::string& more) const {
    std::string arguments = "--techniques '" + (binaryDirectory() / "tests/plugins/hostile").string() +
                            "' --quick --case camera_on_surface " + more;
    for (const std::string& deed : deeds) arguments += " --pipeline '" + file(deed + ".pipeline") + "'";
    return battery(arguments);
  }
};

}  // namespace

TEST_CASE("stiff transport stays sound, and what is biased there is explained", "[slow]") {
  checkQuickFamily("stiff_transport");
}
TEST_CASE("extreme geometry stays sound, and what is biased there is explained", "[slow]") {
  checkQuickFamily("geometry");
}
TEST_CASE("scale and place stay sound, and what is biased there is explained", "[slow]") {
  checkQuickFamily("scale_and_place");
}
TEST_CASE("extreme lights stay sound, and what is biased there is explained", "[slow]") {
  checkQuickFamily("light");
}
TEST_CASE("extreme images and cameras stay sound, and what is biased there is explained", "[slow]") {
  checkQuickFamily("image_and_camera");
}
TEST_CASE("jumps in time stay sound, and what is biased there is explained", "[slow]") {
  checkQuickFamily("time");
}
TEST_CASE("refinement stays sound, and what is biased there is explained", "[slow]") {
  checkQuickFamily("refinement");
}
TEST_CASE("repeated runs give the same bits", "[slow]") {
  checkQuickFamily("repeatability");
}
TEST_CASE("the ends of parameters' ranges stay sound, and what is biased there is explained", "[slow]") {
  checkQuickFamily("parameters");
}

TEST_CASE("a pass that crashes or hangs costs one cell, and the battery goes on") {
  const HostilePlace place;
  const Battery hostile = place.run(
      {"abort", "paint", "fault", "spin", "refuse", "exhaust", "nan"},
      "--time-limit 3s -o '" + place.file("page") + "' --store '" + place.file("results.sqlite") + "'");
  CHECK(hostile.result.exitCode == 1);
  REQUIRE(hostile.cells.size() == 7);
  const auto check = [&](std::size_t index, const char* outcome, const std::string& said) {
    const Json& cell = hostile.cells[index];
    INFO(cell.dump(1));
    CHECK(cell.at("outcome") == outcome);
    CHECK(contains(cell.at("detail"), said));
    CHECK(cell.at("technique") == "hostile");
    CHECK(contains(cell.at("command"), "lumivox stress --case camera_on_surface --pipeline "));
    CHECK(contains(cell.at("command"), "--quick"));
  };
  check(0, "broken", "killed by signal 6");
  check(1, "stable", "");
  check(2, "broken", "killed by signal 11");
  check(3, "broken", "no answer within 3 s");
  check(4, "refused", "the pass refuses; expected a scene of another kind");
  check(5, "refused", "pass paint: out of memory");
  check(6, "broken", "pass paint, port radiance: 1 NaN, first at pixel (3, 2)");

  // A cell that died stands in the store beside the others.
  ResultsStore store(place.file("results.sqlite"), ResultsStore::Mode::read);
  const std::vector<StressCell> stored = store.stressCells();
  REQUIRE(stored.size() == 7);
  CHECK(stored[0].outcome == StressOutcome::broken);
  CHECK(stored[0].device == stored[1].device);
  CHECK(stored[6].image == "images/nan__camera_on_surface.png");
  CHECK(place.has("page/" + stored[6].image));
  CellFilter broken;
  broken.outcome = StressOutcome::broken;
  CHECK(store.stressCells(broken).size() == 4);

  // Cells are listed, exported and removed apart from runs.
  const std::string inStore = " --store '" + place.file("results.sqlite") + "'";
  CHECK(contains(runCommand("lumivox results list --stress --outcome refused" + inStore).output, "2 cells"));
  CHECK(Json::parse(runCommand("lumivox results export --stress --format json" + inStore).output).size() ==
        7);
  CHECK(contains(runCommand("lumivox results export --stress --case camera_on_surface" + inStore).output,
                 "first at pixel (3, 2)"));
  checkRefused(runCommand("lumivox results remove --stress" + inStore), "say which, or --all");
  checkRefused(runCommand("lumivox results list --stress --scene cornell" + inStore), "--family");

  const std::string page = place.read("page/index.html");
  CHECK(contains(page, "Where each technique breaks"));
  CHECK(contains(page, "first at pixel (3, 2)"));
  CHECK(contains(page, "\"image\":\"images/nan__camera_on_surface.png\""));
  CHECK(Json::parse(place.read("page/index.json")).size() == 7);
  // The page can be made again from the store, without running anything.
  const CommandResult again = runCommand("lumivox stress --from '" + place.file("results.sqlite") + "' -o '" +
                                         place.file("again") + "'");
  CHECK(again.exitCode == 1);
  CHECK(contains(place.read("again/index.html"), "first at pixel (3, 2)"));
}

TEST_CASE("the command of a cell repeats it") {
  const HostilePlace place;
  const Battery first = place.run({"nan"}, "");
  const std::string command = first.cells.at(0).at("command");
  const CommandResult again = runCommand(command + " --json");
  CHECK(again.exitCode == 1);
  CHECK(Json::parse(again.output).at(0).at("detail") == first.cells.at(0).at("detail"));
}

TEST_CASE("a report shows the stress cells of its store") {
  const HostilePlace place;
  const std::string store = " --store '" + place.file("results.sqlite") + "'";
  place.run({"paint", "nan"}, store);
  const auto report = [&](const std::string& more) {
    const CommandResult result = runCommand(
        "lumivox report '" + place.scene() + "' --pipeline " + committedPipeline("direct_lighting") +
        " --no-sweep --resolution 8x8 --spp 4 --subpixels 1 --repeats 1 --seeds 1 -o '" +
        place.file("report/index.html") + "'" + more);
    REQUIRE(result.exitCode == 0);
    return place.read("report/index.html");
  };
  const std::string without = report(""), with = report(store);
  CHECK_FALSE(pageRecords(without).contains("stress"));
  CHECK(pageRecords(with).at("stress").size() == 2);
  CHECK(contains(with, "first at pixel (3, 2)"));
  // Images lie beside another page.
  CHECK_FALSE(contains(with, "images/nan"));
  CHECK(Json::parse(place.read("report/index.json")).at("stress").size() == 2);
}

TEST_CASE("images of one scene have one exposure, whichever pipeline made them") {
  const HostilePlace place;
  // A hundredth of the radiance everywhere: at an exposure of its own it would look the same.
  std::string faint = place.read("paint.pipeline");
  faint.replace(faint.find("deed paint"), 10, "deed paint  value 0.01");
  place.write("faint.pipeline", faint);
  const Battery painted = place.run({"paint", "faint"}, "-o '" + place.file("page") + "'");
  INFO(painted.cells.dump(1));
  REQUIRE(place.has("page/images/faint__camera_on_surface.png"));
  CHECK(place.read("page/images/faint__camera_on_surface.png") !=
        place.read("page/images/paint__camera_on_surface.png"));
}

TEST_CASE("what an old view left in frames that accumulate is found, and a mean that begins anew is not") {
  const HostilePlace place;
  const auto outcomeOf = [&](const char* pass) {
    place.write("jump.pipeline", "pipeline \"jump\" {\n  pass a hostile." + std::string(pass) +
                                     "\n\n  output direct a.radiance\n}\n");
    return battery("--techniques '" + (binaryDirectory() / "tests/plugins/hostile").string() +
                   "' --quick --case accumulation_teleport --pipeline '" + place.file("jump.pipeline") + "'")
        .cells.at(0);
  };
  const Json right = outcomeOf("mean { }"), wrong = outcomeOf("mean { trail on }"),
             none = outcomeOf("paint { }");
  INFO(right.dump(1) << wrong.dump(1) << none.dump(1));
  CHECK(right.at("outcome") == "stable");
  CHECK(wrong.at("outcome") == "biased");
  CHECK(wrong.at("value") == 1.0);
  CHECK(contains(wrong.at("detail"), "back again"));
  CHECK(none.at("outcome") == "not_applicable");
  CHECK(contains(none.at("detail"), "goes on from earlier frames"));
}

TEST_CASE("a pipeline without light is judged by what it shows, and told what says nothing about it") {
  const Workplace place;
  place.write(
      "open.pipeline",
      "pipeline \"Open\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass open screen_space.ssao {\n    gbuffer gbuffer\n    samples 4\n  }\n"
      "  pass smooth image_filters.smooth {\n    gbuffer gbuffer\n    occlusion open.occlusion\n  }\n\n"
      "  output ambient_occlusion smooth.occlusion\n}\n");
  const Battery run = battery("--quick --pipeline '" + place.file("open.pipeline") +
                              "' --case image_33x17 --case camera_looks_away --case no_light --case light_1e8"
                              " --case thin_wall_leak --case moved_1000_km --case frame_of_a_sequence"
                              " --case closed_box_one_bounce --case hidden_sender --case environment_only"
                              " --case fov_1_deg --case no_triangles --case turned_30 --case battery_values");
  CHECK(run.result.exitCode == 0);
  REQUIRE(run.cells.size() == 14);
  const std::set<std::string> judged{"image_33x17",         "moved_1000_km", "turned_30",
                                     "frame_of_a_sequence", "fov_1_deg",     "battery_values"};
  for (const Json& cell : run.cells) {
    INFO(cell.dump(1));
    const std::string outcome = cell.at("outcome");
    if (judged.count(cell.at("case")) != 0) {
      CHECK((outcome == "stable" || outcome == "biased"));
      CHECK(cell.at("measure") != "");
    } else {
      CHECK(outcome == "not_applicable");
      CHECK(contains(cell.at("detail"), "none of its outputs is radiance"));
    }
  }
}

TEST_CASE("unknown cases, families and techniques are refused before anything runs") {
  checkRefused(runCommand("lumivox stress --case image_1x2"), "did you mean 'image_1x1'");
  checkRefused(runCommand("lumivox stress --family parameter"), "did you mean 'parameters'");
  checkRefused(runCommand("lumivox stress voxel_cones"), "voxel_cones");
  checkRefused(runCommand("lumivox stress --pipeline absent.pipeline"), "absent.pipeline");
  // A worker that cannot start ends the battery with its own words.
  checkRefused(runCommand("lumivox --quiet --device 99 stress --case image_1x1 --pipeline " +
                          committedPipeline("direct_lighting")),
               "99");
}
