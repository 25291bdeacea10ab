#include <nlohmann/json.hpp>

#include "laboratory/results_sql.h"
#include "lumivox/base/file.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

const std::string kScene = (sourceDirectory() / "scenes/cornell.scene").string();

/// A pipeline with a small sweep, in a folder of its own beside a store.
struct Sweep {
  TemporaryDirectory directory;
  std::string pipeline, store;

  explicit Sweep(const std::string& samples = "[1 2]") {
    pipeline =
        directory
            .write(
                "direct.pipeline",
                "pipeline \"Direct\" {\n"
                "  param area_samples 1 in 1..64\n"
                "  pass gbuffer direct_lighting.gbuffer { }\n"
                "  pass shadow direct_lighting.shadow_map { size 32 area_size 32 area_samples $area_samples }\n"
                "  pass direct direct_lighting.shade { gbuffer gbuffer shadow shadow.depth }\n"
                "  output direct direct.radiance\n"
                "}\n"
                "sweep samples { area_samples " +
                    samples + " }\n")
            .string();
    store = (directory.path() / "results.sqlite").string();
  }
  CommandResult run(const std::string& more = {}, const std::string& format = "--json") const {
    return typed("-q sweep", kScene, "--pipeline", pipeline, "--store", store,
                 "--resolution 16x16 --spp 4 --subpixels 1 --repeats 2 --seeds 1", Raw{format}, Raw{more});
  }
  /// `results` of the store.
  CommandResult results(const char* what) const { return typed("results", what, "--store", store); }
};

}  // namespace

TEST_CASE("a sweep measures what the store lacks, and the same sweep again measures nothing") {
  const Sweep sweep;
  const CommandResult plan = sweep.run("--plan");
  CHECK(Json::parse(plan.output)["missing"].size() == 2);
  const std::string text =
      typed("-q sweep", kScene, "--pipeline", sweep.pipeline, "--store", sweep.store, "--plan").output;
  CHECK(contains(text, "2 points are missing, 0 already in the store"));
  const CommandResult first = sweep.run();
  INFO(first.errors);
  REQUIRE(first.exitCode == 0);
  const Json measured = Json::parse(first.output);
  CHECK(measured["measured"] == 2);
  CHECK(measured["held"] == 0);
  REQUIRE(measured["runs"].size() == 2);
  for (const Json& run : measured["runs"]) {
    CHECK(run["frame_ms"]["repeats"] == 2);
    CHECK(run["frame_ms"]["median"] > 0.0);
    CHECK(run["passes"].size() == 3);
    CHECK(run["errors"].size() > 0);
    CHECK(run["peak_bytes"] > 0);
    for (const Json& pass : run["passes"]) {
      INFO(pass.dump());
      CHECK(pass["work"].size() > 0);
    }
  }
  // The views of the area light are drawn twice as often, the scene is seen as before.
  const auto workOf = [&](std::size_t run, const char* pass, const char* what) {
    for (const Json& one : measured["runs"][run]["passes"])
      if (one["name"] == pass) return one["work"].at(what).get<double>();
    return 0.0;
  };
  CHECK(workOf(0, "gbuffer", "fragments") == workOf(1, "gbuffer", "fragments"));
  CHECK(workOf(1, "shadow", "draws") == 2.0 * workOf(0, "shadow", "draws"));
  // The same numbers: nothing was measured anew.
  const Json again = Json::parse(sweep.run().output);
  CHECK(again["measured"] == 0);
  CHECK(again["held"] == 2);
  CHECK(again["runs"] == measured["runs"]);
  CHECK(Json::parse(sweep.run("--plan").output)["missing"].empty());
}

TEST_CASE("a longer sweep, another seed or another text costs only its own points") {
  const Sweep sweep;
  REQUIRE(sweep.run().exitCode == 0);
  CHECK(Json::parse(sweep.run("--seed 2").output)["measured"] == 2);
  CHECK(Json::parse(sweep.run("--set area_samples=3").output)["measured"] == 1);
  std::string text = readFile(sweep.pipeline);
  writeFileAtomically(sweep.pipeline, text + "# a remark changes the text\n");
  CHECK(Json::parse(sweep.run().output)["measured"] == 2);
  writeFileAtomically(sweep.pipeline, text);
  CHECK(Json::parse(sweep.run().output)["measured"] == 0);
}

TEST_CASE("the memory of a point does not count the points that are timed beside it") {
  const Sweep both("[1 8]"), alone("[8]");
  const Json pair = Json::parse(both.run().output)["runs"], one = Json::parse(alone.run().output)["runs"];
  const auto bytesOf = [](const Json& runs) {
    for (const Json& run : runs)
      if (run["parameters"]["area_samples"] == "8") return run["peak_bytes"].get<std::uint64_t>();
    return std::uint64_t{0};
  };
  CHECK(bytesOf(pair) == bytesOf(one));
  CHECK(bytesOf(one) > 0);
}

TEST_CASE(
    "a point that fits into memory alone but not beside the others is timed after them, and is no failure") {
  const TemporaryDirectory directory;
  const CommandResult swept = ran("--memory 64MiB sweep", kScene, "--pipeline",
                                  sourceDirectory() / "scenes/pipelines/voxel_cone_tracing.pipeline",
                                  "--store", directory.path() / "results.sqlite",
                                  "--resolution 16x16 --spp 4 --subpixels 1 --seeds 1 --repeats 1 --json");
  const Json summary = Json::parse(swept.output);
  CHECK(summary["failed"] == 0);
  CHECK(summary["measured"] == 4);
  CHECK(contains(swept.errors, "timed after the 3 points before it"));
}

TEST_CASE("results are listed, exported, merged and removed from the command line") {
  const Sweep sweep;
  REQUIRE(sweep.run().exitCode == 0);
  const CommandResult list = sweep.results("list --scene cornell");
  CHECK(list.exitCode == 0);
  CHECK(contains(list.output, "area_samples=2"));
  CHECK(contains(list.output, "2 runs"));
  const std::string none = sweep.results("list --scene arcade").output;
  CHECK(contains(none, "0 runs"));
  CHECK(contains(none, "it has runs of the scenes cornell; of the pipelines direct"));

  const std::string csv = sweep.results("export --set area_samples=2").output;
  const auto columns = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  const std::size_t head = csv.find("\r\n");
  REQUIRE(head != std::string::npos);
  // Fields that hold commas are quoted; these have none but the device and the host.
  CHECK(columns(csv.substr(0, head)) > 50);
  CHECK(csv.substr(0, head).find(",parameter_area_samples") != std::string::npos);
  CHECK(contains(csv, "area_samples=2"));
  CHECK(csv.find("area_samples=1") == std::string::npos);
  // A sweep prints what it measured, or finds, under the same header.
  const std::string swept = sweep.run("", "--csv").output;
  CHECK(swept.substr(0, swept.find("\r\n")) == csv.substr(0, head));
  const std::string nothing = sweep.results("export --scene arcade").output;
  CHECK(nothing == csv.substr(0, csv.find(",parameter_")) + "\r\n");
  const auto file = sweep.directory.path() / "results.json";
  CHECK(typed("results export --format json -o", file, "--store", sweep.store).exitCode == 0);
  CHECK(Json::parse(readFile(file)).size() == 2);

  const std::string other = (sweep.directory.path() / "other.sqlite").string();
  CHECK(contains(typed("results merge", sweep.store, "--store", Raw{other}).output, "2 runs"));
  const std::filesystem::path earlier = sweep.directory.path() / "earlier.sqlite";
  writeEarlierStore(earlier, 8);
  const CommandResult refused = typed("results list --store", earlier);
  CHECK(refused.exitCode == 2);
  CHECK(contains(refused.errors, "lumivox results import " + earlier.string()));
  const std::string imported = (sweep.directory.path() / "imported.sqlite").string();
  CHECK(contains(typed("results import", earlier, "--store", Raw{imported}).output,
                 "2 runs, 2 stress cells, 1 peak rates"));
  CHECK(contains(typed("results list --store", Raw{imported}).output, "2 runs"));
  CHECK(contains(typed("results remove --set area_samples=1 --dry-run --store", Raw{other}).output,
                 "1 runs would be removed"));
  CHECK(typed("results remove --set area_samples=1 --store", Raw{other}).output == "1 runs removed\n");
  const CommandResult changes = ran("compare-runs", sweep.store, Raw{other}, "--json");
  const Json compared = Json::parse(changes.output);
  CHECK(compared["compared"] == 1);
  CHECK(compared["only_before"].size() == 1);
  for (const Json& change : compared["changes"]) CHECK(change["significant"] == false);
  CHECK(contains(typed("compare-runs 1 2 --all --store", sweep.store).output, "1 point compared"));
}

TEST_CASE("bad requests to the results store are refused with what was expected") {
  const Sweep sweep;
  checkRefused(sweep.results("list"), "no results store");
  CHECK_FALSE(std::filesystem::exists(sweep.store));
  REQUIRE(sweep.run().exitCode == 0);
  checkRefused(sweep.results("remove"), "--all");
  checkRefused(typed("compare-runs 1 99 --store", sweep.store), "run", 99);
  for (const char* what : {"list --set area_samples", "export --format xml", ""})
    CHECK(sweep.results(what).exitCode == 2);
  const auto text = sweep.directory.write("broken.sqlite", std::string(4096, 'x'));
  CHECK(typed("results merge", text, "--store", sweep.store).exitCode == 2);
  CHECK(typed("-q sweep", kScene, "--store", text).exitCode == 2);
}
