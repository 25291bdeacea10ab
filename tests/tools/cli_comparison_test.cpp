// Comparison of pipelines in a store, and the needs of many scenes, on the command line.
#include <regex>
#include <sstream>

#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Direct light alone, and with light that bounces once: the one is quicker, the other misses less.
constexpr const char* kDirect =
    "pipeline \"Direct\" {\n  param samples 1 in 1..16\n  pass gbuffer direct_lighting.gbuffer { }\n"
    "  pass shadow direct_lighting.shadow_map { size 64  area_samples $samples }\n"
    "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n"
    "  output direct direct.radiance\n}\n";

struct Swept {
  Workplace place;
  std::string store;
  Swept() : store(place.file("results.sqlite")) {
    place.write("direct.pipeline", kDirect);
    const CommandResult result = ran(
        "sweep", place.scene(), "--pipeline", place.file("direct.pipeline"),
        committedPipeline("voxel_cone_tracing"),
        "-q --set cones=4 --set resolution=8 --no-sweep --spp 64 --subpixels 4 --repeats 3 --store", store);
  }
  CommandResult results(const std::string& what) const {
    return typed("results", Raw{what}, "--store", store);
  }
  nlohmann::json json(const std::string& what) const {
    const CommandResult result = results(what + " --json");
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    const auto list = nlohmann::json::parse(result.output);
    REQUIRE_FALSE(list.empty());
    return list.back();  // of one scene on one device the whole image
  }
};

}  // namespace

TEST_CASE("a store tells the front, the errors at equal time and the times at equal error of its pipelines") {
  const Swept swept;
  const auto front = swept.json("front");
  CHECK(front.at("component") == "final");
  CHECK(front.at("reference") == "full");
  CHECK(front.at("metric") == "flip");
  CHECK(front.at("points").size() == 2);
  const double quick = front.at("points").at(0).at("frame_ms").at("median");
  const double slow = front.at("points").at(1).at("frame_ms").at("median");
  CHECK(quick <= slow);

  // Between the two times one of the pipelines is slower, beyond them neither.
  const std::string between = std::to_string(0.5 * (quick + slow));
  for (const auto& pipeline : swept.json("equal-time --frame-time " + between + "ms").at("pipelines"))
    CHECK(pipeline.at("equal_time").size() == 1);
  for (const auto& pipeline : swept.json("equal-time --frame-time 1000s").at("pipelines"))
    CHECK(pipeline.at("equal_time").at(0).at("reach") == "at_most");
  for (const auto& pipeline : swept.json("equal-error --error 1e-9").at("pipelines"))
    CHECK(pipeline.at("equal_error").at(0).at("reach") == "not_reached");
  for (const auto& pipeline : swept.json("equal-error --error 1e9 --metric flip").at("pipelines"))
    CHECK(pipeline.at("equal_error").at(0).at("reach") == "at_most");
  CHECK(swept.json("front --against bias --component indirect_diffuse").at("reference") ==
        "one_bounce_diffuse");

  const CommandResult text = swept.results("front");
  CHECK(contains(text.output, "on the front"));
  CHECK(contains(text.output, "room, camera main, 24x16"));
  CHECK(contains(swept.results("equal-time --frame-time 1000s").output, "<= "));
  CHECK(contains(swept.results("equal-error --error 1e-9").output, "not reached"));
  CHECK(contains(swept.results("front --component scattered").output, "no run has"));
}

TEST_CASE("comparisons that make no sense are refused with what was expected") {
  const Workplace place;
  const auto refused = [&](const std::string& arguments, const std::string& named) {
    checkRefused(typed("results", Raw{arguments}, "--store", place.file("none.sqlite")), named);
  };
  refused("equal-time --frame-time -3ms", "--frame-time '-3ms'");
  refused("equal-time --budget 16ms", "a budget is time for measuring; expected --frame-time 16ms");
  refused("equal-time --frame-time 3kg", "expected a time above 0");
  refused("equal-error --error nothing", "expected a number above 0");
  refused("front --metric flop", "did you mean 'flip'");
  refused("front --component indirect_difuse", "did you mean 'indirect_diffuse'");
  refused("front", "none.sqlite");
}

TEST_CASE("explain sets scenes against pipelines, and says which scene's model is not here") {
  const Workplace place;
  place.write("direct.pipeline", kDirect);
  place.write("lost.scene",
              "scene \"Lost\" {\n  camera main { eye 0 0 1  target 0 0 0  fov 40 deg  resolution 8 8 }\n"
              "  mesh lost { file \"other_models/nowhere.obj\" }\n}\n");
  const std::string command = "lumivox explain -q --no-times --set resolution=8 '" + place.scene() + "' '" +
                              place.file("lost.scene") + "' '" + place.file("direct.pipeline") +
                              "' --pipeline '" + committedPipeline("voxel_cone_tracing") +
                              "' --resolution 16x16";
  const CommandResult result = runCommand(command + " --json");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  const auto cells = nlohmann::json::parse(result.output).at("cells");
  REQUIRE(cells.size() == 4);
  CHECK(cells.at(0).at("passes_kept") == 3);
  CHECK(cells.at(0).at("same_image").get<bool>());
  CHECK(cells.at(0).at("frame_ms").is_null());
  CHECK(cells.at(1).at("passes_total").get<int>() > 3);
  CHECK(cells.at(1).at("variants_needed") < cells.at(1).at("variants_compiled"));
  CHECK(contains(cells.at(2).at("absent").get<std::string>(), "other_models/nowhere.obj"));
  CHECK_FALSE(cells.at(3).at("failed").get<bool>());

  const CommandResult text = runCommand(command);
  CHECK(contains(text.output, "3/3"));
  CHECK(contains(text.output, "room                  passes"));
  CHECK(contains(text.output, "\n  voxel_cone_tracing  "));
  CHECK(contains(text.output, "lost                  absent"));
  CHECK(contains(text.output, "bit for bit: 2 of 2; 2 absent"));
}

TEST_CASE("the matrix of explain fits into a terminal of 100 columns, whatever pipelines are called") {
  const Workplace place;
  const std::string longName = std::string(90, 'x') + ".pipeline";
  place.write(longName, kDirect);
  place.write(
      "smoke_alone.pipeline",
      "pipeline \"Smoke alone\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass shadow direct_lighting.shadow_map { }\n"
      "  pass particles volumetric_smoke.particles { }\n"
      "  pass smoke volumetric_smoke.insert { particles particles.particles }\n"
      "  pass march volumetric_smoke.march { gbuffer gbuffer  media smoke.media  shadow shadow.depth  "
      "resolution full }\n"
      "  output scattered march.scattered\n}\n");
  const CommandResult result = ran("explain -q --repeats 1", place.scene(), place.file(longName),
                                   "--resolution 16x16 --pipeline", place.file("smoke_alone.pipeline"));
  CHECK(contains(result.output, "first ms"));
  CHECK(std::regex_search(result.output, std::regex("xx\\.\\. +3/3")));
  CHECK(contains(result.output, "smoke_alone does not suit room: "));
  std::istringstream lines(result.output);
  for (std::string line; std::getline(lines, line);) {
    INFO(line);
    CHECK(line.size() <= 100);
  }
}

TEST_CASE("explain of one scene and one pipeline goes without times when it is told to") {
  const Workplace place;
  place.write("direct.pipeline", kDirect);
  const CommandResult result = typed("explain -q --no-times", place.scene(), place.file("direct.pipeline"));
  INFO(result.errors);
  CHECK(result.exitCode == 0);
  CHECK(contains(result.output, "3 of 3 passes kept"));
  CHECK_FALSE(contains(result.output, "whole frame"));
  checkRefused(typed("explain"), "expected a scene's text, or --all");
  checkRefused(typed("explain --all", place.scene()), "--all takes every committed scene");
  checkRefused(typed("explain", place.scene(), place.file("direct.pipeline"), "--set sampels=2"),
               "did you mean 'samples'");
}
