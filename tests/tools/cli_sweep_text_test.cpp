// Texts of sweeps: checked, described, laid out and measured.
#include <set>

#include "lumivox/dsl/document.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

std::string data(const std::string& name) {
  return (sourceDirectory() / "tests/tools/data/sweeps" / name).string();
}

CommandResult check(const std::string& name) {
  return typed("check", data(name));
}

/// The sweep of small.sweep at the least cost.
CommandResult measure(const std::string& store, const std::string& more = {}) {
  return runCommand("lumivox -q sweep " + data("small.sweep") + " --store " + store +
                    " --resolution 12x12 --spp 2 --subpixels 1 --repeats 1 --json " + more);
}

}  // namespace

TEST_CASE("check tells everything that is wrong in a text of sweeps, each at its place") {
  const CommandResult words = check("wrong_words.sweep");
  checkFindings(words, {{"wrong_words.sweep:1:15", Tells("gird", "did you mean", "grid")},
                        {"wrong_words.sweep:2:46", Tells("no file")},
                        {"wrong_words.sweep:2:62", Tells("twice")},
                        {"wrong_words.sweep:3:14", Tells(2, "twice")},
                        {"wrong_words.sweep:3:16", Tells("seed")},
                        {"wrong_words.sweep:3:20", Tells("seed")},
                        {"wrong_words.sweep:4:21", Tells("value")},
                        {"wrong_words.sweep:5:3", Tells("resolution", "twice")},
                        {"wrong_words.sweep:6:3", Tells("list", "cones")},
                        {"wrong_words.sweep:7:15", Tells("upper end")},
                        {"wrong_words.sweep:8:23", Tells("backwards")},
                        {"wrong_words.sweep:9:3", Tells("steps")},
                        {"wrong_words.sweep:1:1", Tells("pipelines")},
                        {"wrong_words.sweep:11:1", Tells("pipeline")},
                        {"wrong_words.sweep:14:14", Tells("file")}});
  CHECK_THAT(words.errors, Tells("second", "Words"));
  checkFindings(check("wrong_values.sweep"),
                {{"wrong_values.sweep:7:25", Tells("resolution")},
                 {"wrong_values.sweep:8:3", Tells("conez", "did you mean", "cones")},
                 {"wrong_values.sweep:9:16", Tells("samples")}});
  checkFindings(check("unequal.sweep"), {{"unequal.sweep:5:3", Tells("cones", 2, "resolution", 3)}});
}

TEST_CASE("the committed sweeps pass check and stand in the canonical layout") {
  const auto folder = sourceDirectory() / "scenes/sweeps";
  std::size_t seen = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    INFO(entry.path());
    const CommandResult result = typed("check", entry.path());
    INFO(result.errors);
    CHECK(result.exitCode == 0);
    const dsl::Document document = dsl::parse(readFile(entry.path()), entry.path());
    REQUIRE(document.findings.empty());
    CHECK(dsl::format(document) == readFile(entry.path()));
    ++seen;
  }
  CHECK(seen >= 1);
}

TEST_CASE("describe knows the words of sweeps, and a text without a name is told by its blocks") {
  CHECK(contains(typed("describe sweep").output, "scenes [...] pipelines [...]"));
  CHECK(contains(typed("describe seeds").output, "a run of its own"));
  const Workplace place;
  place.write("unnamed", "sweep s { scenes [\"room.scene\"]  pipelines [\"none.pipeline\"] }\n");
  checkRefused(typed("check", place.file("unnamed")), "none.pipeline");
}

TEST_CASE("one text measures scenes by pipelines by parameters by seeds, and the same text again nothing") {
  const TemporaryDirectory directory;
  const std::string store = (directory.path() / "results.sqlite").string();
  // Cone tracing has 2 resolutions, direct lighting none: (2 + 1) points by 2 scenes by 2 seeds.
  const CommandResult plan = measure(store, "--plan");
  INFO(plan.errors);
  REQUIRE(plan.exitCode == 0);
  const Json planned = Json::parse(plan.output);
  CHECK(planned["missing"].size() == 12);
  REQUIRE(planned["notes"].size() == 2);
  CHECK(contains(planned["notes"][0].get<std::string>(),
                 "small.sweep:9:3: pipeline \"Direct lighting\" has no parameter 'resolution'"));
  const CommandResult first = measure(store);
  INFO(first.errors);
  REQUIRE(first.exitCode == 0);
  const Json measured = Json::parse(first.output);
  CHECK(measured["measured"] == 12);
  std::set<std::string> points;
  for (const Json& run : measured["runs"]) {
    CHECK(run["seeds"] == 1);
    points.insert(run["scene"].get<std::string>() + run["pipeline"].get<std::string>() +
                  run["parameters"].dump() + run["seed"].dump());
    CHECK((run["seed"] == 3 || run["seed"] == 5));
  }
  CHECK(points.size() == 12);
  CHECK(Json::parse(measure(store).output)["measured"] == 0);

  // Direct light has no random numbers, and both seeds are judged against one reference: the same errors to
  // the bit.
  std::vector<Json> direct;
  for (const Json& run : measured["runs"])
    if (contains(run["pipeline"], "direct_lighting") && contains(run["scene"], "cornell"))
      direct.push_back(run["errors"]);
  REQUIRE(direct.size() == 2);
  CHECK_FALSE(direct[0].empty());
  CHECK(direct[0] == direct[1]);

  // The command that a run carries measures the same point: the store knows it already.
  const std::string again = measured["runs"][0]["command"];
  const auto words = again.find(" report ");
  REQUIRE(words != std::string::npos);
  const CommandResult repeated = runCommand("cd '" + sourceDirectory().string() + "' && '" +
                                            (binaryDirectory() / "bin/lumivox").string() + "' -q sweep " +
                                            again.substr(words + 8) + " --store " + store + " --json");
  INFO(again << "\n" << repeated.errors);
  REQUIRE(repeated.exitCode == 0);
  CHECK(Json::parse(repeated.output)["held"] == 1);
  CHECK(Json::parse(repeated.output)["measured"] == 0);

  CHECK(Json::parse(measure(store, "--set resolution=16 --plan").output)["missing"].empty());
  CHECK(Json::parse(measure(store, "--set resolution=12 --plan").output)["missing"].size() == 4);
}

TEST_CASE("a sweep text with other pipelines, or settings that none of its pipelines has, is refused") {
  const TemporaryDirectory directory;
  const std::string store = (directory.path() / "results.sqlite").string();
  checkRefused(measure(store, "--pipeline " + committedPipeline("direct_lighting")), "names its pipelines");
  checkRefused(measure(store, "--set resolutoin=16"), "did you mean 'resolution'");
}
