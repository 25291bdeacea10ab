// Voxels beside errors, as commands tell them; and light of one quantity where another is expected.
#include <fmt/format.h>

#include <sstream>

#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

/// A committed pipeline with other lines in place of some of its own.
std::string changedPipeline(const std::string& name,
                            const std::vector<std::pair<std::string, std::string>>& changes) {
  std::string text = readFile(committedPipeline(name));
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
  }
  return text;
}

std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

}  // namespace

TEST_CASE("a sweep over the density of points keeps recall, precision and holes, and its export has them") {
  const Workplace place;
  std::string text = changedPipeline("imperfect_volumes", {});
  text.erase(text.find("sweep quality"));
  place.write("points.pipeline", text + "sweep imperfection {\n  density [0.25 1 4]\n}\n");
  const std::string store = "--store '" + place.file("results.sqlite") + "'";
  const CommandResult made = ran(
      "-q sweep", place.scene(), "--pipeline", place.file("points.pipeline"),
      "--set resolution=16 --set rays=16 --resolution 12x8 --spp 4 --subpixels 1 --repeats 1 --seeds 1 --json",
      Raw{store});
  std::map<double, Json> byDensity;
  const Json output = Json::parse(made.output);
  for (const Json& run : output.at("runs")) {
    const Json& voxels = run.at("voxels");
    CHECK(voxels.at("output") == "voxels.fragments");
    CHECK(voxels.at("kind") == "VoxelFragments");
    CHECK(voxels.at("resolution").dump() == "[16,16,16]");
    byDensity[std::stod(run.at("parameters").at("density").get<std::string>())] = voxels;
  }
  REQUIRE(byDensity.size() == 4);  // the default, 8, beside the sweep
  double recall = 0.0, holes = 1.0;
  for (const auto& [density, voxels] : byDensity) {
    INFO(density << ": " << voxels.dump());
    CHECK(voxels.at("recall").get<double>() > recall);
    CHECK(voxels.at("axis_share").get<double>() <= holes);
    CHECK(voxels.at("precision").get<double>() > 0.99);
    recall = voxels.at("recall").get<double>();
    holes = voxels.at("axis_share").get<double>();
  }

  const CommandResult exported = ran("results export", Raw{store}, "--format csv");
  std::istringstream lines(exported.output);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> head = fieldsOf(line);
  const auto columnOf = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin());
  };
  const std::size_t column = columnOf("recall");
  REQUIRE(column < head.size());
  CHECK(columnOf("precision") == column + 1);
  CHECK(columnOf("axis_holes") == column + 2);
  CHECK(columnOf("oblique_holes") == column + 3);
  CHECK(exported.output.find(fmt::format(
            ",voxels.fragments,,{},", byDensity.at(0.25).at("recall").get<double>())) != std::string::npos);
  const Json json = Json::parse(typed("results export", Raw{store}, "--format json").output);
  CHECK(json.dump().find("\"axis_share\"") != std::string::npos);
}

TEST_CASE(
    "light of one quantity where another is expected is refused by name, as pipeline texts connect it") {
  const Workplace place;
  const auto refusal = [&](const std::string& text) {
    place.write("mixed.pipeline", text);
    const CommandResult result = typed("-q render", place.scene(), place.file("mixed.pipeline"),
                                       "--resolution 8x8 -o", place.file("image.exr"));
    INFO(result.output << result.errors);
    CHECK(result.exitCode != 0);
    CHECK_FALSE(place.has("image.exr"));
    return unwrapped(result.errors);
  };
  // Radiance of an imperfect volume, read as the flux of a propagation volume.
  const std::string radiance = refusal(changedPipeline(
      "light_propagation_volumes", {{"  pass inject light",
                                     "  pass own imperfect_volumes.inject {\n"
                                     "    fragments voxels.fragments\n"
                                     "    shadow shadow.depth\n  }\n"
                                     "  pass inject light"},
                                    {"light propagate.light\n    faces", "light own.reflected\n    faces"}}));
  INFO(radiance);
  CHECK(contains(radiance, "contains radiance"));
  CHECK(contains(unwrapped(radiance), "expected flux in W/sr"));
  // And the other way round.
  const std::string flux = refusal(
      changedPipeline("imperfect_volumes", {{"  pass inject imperfect_volumes.inject {",
                                             "  pass flux light_propagation_volumes.inject_voxels {\n"
                                             "    fragments voxels.fragments\n    shadow shadow.depth\n"
                                             "    resolution 16\n    levels 1\n  }\n"
                                             "  pass inject imperfect_volumes.inject {"},
                                            {"reflected inject.reflected", "reflected flux.light"}}));
  INFO(flux);
  CHECK(contains(flux, "contains flux"));
  CHECK(contains(unwrapped(flux), "expected radiance in W/(sr m^2)"));
}
