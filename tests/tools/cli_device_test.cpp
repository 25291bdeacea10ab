// The peak rates of the device from the command line, and how a report and the store use them.
#include "support/drawn_page.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

constexpr const char* kPipeline =
    "pipeline \"Quick\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
    "  pass shadow direct_lighting.shadow_map { size 64 }\n"
    "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n  output direct "
    "direct.radiance\n}\n";

}  // namespace

TEST_CASE("peak rates are measured, told with the device's limits, and kept in the store that is named") {
  const Workplace place;
  const std::string store = place.file("results.sqlite");
  const std::string command =
      "lumivox -q device --repeats 2 --only float_operations --only image_writes_d2_rgba32f";
  const CommandResult json = runCommand(command + " --json --store " + store);
  INFO(json.errors);
  REQUIRE(json.exitCode == 0);
  const Json told = Json::parse(json.output);
  CHECK_FALSE(told.at("device").at("renderer").get<std::string>().empty());
  CHECK(told.at("device").at("largest_buffer_bytes").get<std::uint64_t>() > 0);
  CHECK(told.at("device").contains("timer_note"));
  REQUIRE(told.at("peak_rates").size() == 2);
  for (const Json& peakRate : told.at("peak_rates")) {
    CHECK(peakRate.at("median").get<double>() > 1e6);
    CHECK(peakRate.at("repeats") == 2);
  }
  CHECK(told.at("store") == store);
  CHECK(place.has("results.sqlite"));
  const CommandResult text = runCommand(command + " --store " + store);
  CHECK(contains(text.output, "float_operations"));
  CHECK(contains(text.output, "operations/s"));
  CHECK(contains(text.output, "Largest volume"));
  checkRefused(typed("device --only sampling --store", Raw{store}), "texture_samples_d2_rgba8_nearest");
  checkRefused(typed("device --repeats 0 --store", Raw{store}), "--repeats");
}

TEST_CASE(
    "a report says how far each pass is from the peak rates in its store, and how to get them otherwise") {
  const Workplace place;
  const std::string store = place.file("results.sqlite");
  place.write("quick.pipeline", kPipeline);
  const auto report = [&](const std::string& more) {
    const CommandResult result =
        ran("report", place.scene(), "--pipeline", place.file("quick.pipeline"),
            "-q --spp 16 --subpixels 1 --seeds 2 --repeats 2 -o", place.file("page.html"), Raw{more});
    return Json::parse(place.read("page.json"));
  };
  const Json without = report("");
  CHECK(without.at("peak_rates").empty());
  const bool draws = canDrawPages();
  if (draws) CHECK(contains(drawnPage(place.file("page.html")).at("html"), "<code>lumivox device</code>"));
  const bool counted = without.at("scenes").at(0).at("points").at(0).at("not_counted") == "";

  ran("-q device --repeats 2 --only float_operations --only triangles --only draws --only image_writes_d2_rgba32f --store",
      Raw{store});
  const Json with = report("--store " + store);
  CHECK(with.at("peak_rates").size() == 4);
  if (!counted) return skip("this driver takes GLSL, and operations are counted in SPIR-V");
  for (const Json& pass : with.at("scenes").at(0).at("points").at(0).at("passes")) {
    INFO(pass.at("name"));
    CHECK(pass.at("work").size() > 2);
    CHECK_FALSE(pass.at("limited_by").get<std::string>().empty());
    CHECK(pass.at("of_peak_rate").get<double>() > 0.0);
    const double least = pass.at("at_least_ms").at(pass.at("limited_by").get<std::string>()).get<double>();
    CHECK(pass.at("of_peak_rate").get<double>() ==
          Approx(least / pass.at("device_ms").at("median").get<double>()));
  }
  const Json& shade = with.at("scenes").at(0).at("points").at(0).at("passes").at(2);
  CHECK(shade.at("work").at("image_writes_d2_rgba32f") == 24 * 16);
  if (!draws) return;
  const std::string page = drawnPage(place.file("page.html")).at("text");
  CHECK(contains(page, "Limited by"));
  CHECK(contains(page, "What this device can do at most"));
}
