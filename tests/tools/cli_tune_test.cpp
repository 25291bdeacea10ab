#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "lumivox/analysis/interpolation.h"
#include "lumivox/base/file.h"
#include "support/support.h"
#include "tools/cli_support.h"
#include "tools/started.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

const std::string kScene = (sourceDirectory() / "scenes/cornell.scene").string();

struct Tuning {
  TemporaryDirectory directory;
  std::string pipeline, store;

  Tuning() {
    pipeline =
        directory
            .write("direct.pipeline",
                   "pipeline \"Direct\" {\n"
                   "  param samples 1 in 1..16 # of the area light\n"
                   "  pass gbuffer direct_lighting.gbuffer { }\n"
                   "  pass shadow direct_lighting.shadow_map { size 32 area_size 32 area_samples $samples }\n"
                   "  pass direct direct_lighting.shade { gbuffer gbuffer shadow shadow.depth }\n"
                   "  output direct direct.radiance\n"
                   "}\n")
            .string();
    store = (directory.path() / "results.sqlite").string();
  }
  CommandResult run(const std::string& more) const {
    return runCommand("lumivox -q tune " + kScene + " --pipeline " + pipeline + " --store " + store +
                      " --resolution 24x24 --spp 64 --subpixels 1 --repeats 3 --seeds 2 " + more);
  }
};

/// Whether two points of a search cannot be told apart by a number, as far as their times have a floor of 5
/// %.
bool isAlike(const Json& one, const Json& other, const std::string& number) {
  if (one == other) return true;
  if (one["undecided"] == true || other["undecided"] == true) return false;
  const bool isTime = number == "time";
  const auto measured = [&](const Json& point) {
    return Measured{point[isTime ? "time_ms" : "error"].get<double>(),
                    point[isTime ? "time_uncertainty_ms" : "error_uncertainty"].get<double>()};
  };
  return !differ(measured(one), measured(other), isTime ? kSignificantTimeShare : 0.0);
}

}  // namespace

TEST_CASE("a search ends at the fastest of the points whose error cannot be told apart from the least") {
  const Tuning tuning;
  const CommandResult result = tuning.run("--frame-time 1000s --output direct --metric percentile95 --json");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  const Json json = Json::parse(result.output);
  CHECK(json["exhausted"] == true);
  const Json& seen = json["seen"];
  REQUIRE(seen.size() > 3);
  const Json& winner = seen[json["winner"].get<std::size_t>()];
  const Json& least = seen[json["least"].get<std::size_t>()];
  CHECK(isAlike(least, winner, "error"));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    INFO(seen[i].dump());
    if (i > 0) CHECK(seen[i]["time_ms"] >= seen[i - 1]["time_ms"]);
    // Whole numbers stay whole.
    CHECK(seen[i]["parameters"]["samples"].get<std::string>().find('.') == std::string::npos);
    CHECK(seen[i]["error"] >= least["error"]);
    if (seen[i]["on_front"] == true && isAlike(least, seen[i], "error"))
      CHECK(seen[i]["time_ms"] >= winner["time_ms"]);
  }
}

TEST_CASE("a search judges by FLIP unless another metric is asked for, and gives its points as CSV") {
  const Tuning tuning;
  const CommandResult table = tuning.run("--frame-time 1000s");
  INFO(table.errors);
  REQUIRE(table.exitCode == 0);
  CHECK(contains(table.output, "the best within 1000000 ms: direct, flip "));
  CHECK(contains(table.output, "\njudged: the whole image, flip against "));
  const std::string csv = tuning.run("--frame-time 1000s --csv").output;
  CHECK(csv.rfind("run,created,scene,pipeline,", 0) == 0);
  CHECK(csv.substr(0, csv.find("\r\n")).find(",parameter_samples") != std::string::npos);
  CHECK(tuning.run("--frame-time 1000s --csv --json").exitCode == 2);
}

TEST_CASE("the front of a search is the front that the results store shows of the same points") {
  const Tuning tuning;
  const CommandResult result = tuning.run("--frame-time 1000s --output direct --metric rmse --json");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  using Front = std::map<std::string, bool>;
  Front searched, stored;
  const Json found = Json::parse(result.output);
  for (const Json& point : found["seen"])
    searched[point["parameters"].dump()] = point["on_front"].get<bool>();
  const CommandResult front =
      ran("results front --component direct --metric rmse --json --store", tuning.store);
  const Json groups = Json::parse(front.output);
  INFO(groups.dump());
  REQUIRE(groups.size() == 1);
  for (const Json& point : groups[0]["points"])
    stored[point["parameters"].dump()] = point["on_front"].get<bool>();
  CHECK(searched.size() > 3);
  CHECK(searched == stored);
}

TEST_CASE("the winning text is the pipeline with its parameters as defaults, and measures the same") {
  const Tuning tuning;
  const auto best = tuning.directory.path() / "best.pipeline";
  const CommandResult result = tuning.run("--error 100 --output direct --json -o " + best.string());
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  const Json json = Json::parse(result.output);
  const Json winner = json["seen"][json["winner"].get<std::size_t>()];
  // Everything fits: of what cannot be told apart from the fastest, the least error wins.
  CHECK(json["least"] == 0);
  const Json& fastest = json["seen"][0];
  CHECK(isAlike(fastest, winner, "time"));
  for (const Json& point : json["seen"])
    if (point["on_front"] == true && isAlike(fastest, point, "time"))
      CHECK(point["error"] >= winner["error"]);
  const std::string text = readFile(best);
  CHECK(text.find("param samples " + winner["parameters"]["samples"].get<std::string>() + " in 1..16") !=
        std::string::npos);
  CHECK(contains(text, "# of the area light"));
  CHECK(typed("check", best).exitCode == 0);
  CHECK(typed("fmt --check", best).exitCode == 0);
}

TEST_CASE("a limit that nothing meets writes no pipeline and says so") {
  const Tuning tuning;
  const auto best = tuning.directory.path() / "best.pipeline";
  const CommandResult result = tuning.run("--error 1e-9 --evaluations 2 -o " + best.string());
  CHECK(result.exitCode == 1);
  CHECK(result.output.find("nothing fits within flip 1e-09; judged: flip of the whole image") !=
        std::string::npos);
  CHECK_FALSE(std::filesystem::exists(best));
}

TEST_CASE("a search says how long it takes before it begins, and that is what it takes") {
  const Place place;
  const std::vector<std::string> limits{"--frame-time",  "100s", "--output", "direct",
                                        "--evaluations", "8",    "--store",  place.file("r.sqlite")};
  const auto begun = std::chrono::steady_clock::now();
  const CommandResult result = place.run("tune", {"slow"}, limits);
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  INFO(result.errors << result.output);
  REQUIRE(result.exitCode == 0);
  const std::string told = "tuning: 8 points at most, 0 of the first 4 in the store: about ";
  const std::size_t at = result.errors.find(told);
  REQUIRE(at != std::string::npos);
  CHECK(at < result.errors.find("slow.pipeline"));
  CHECK(contains(result.errors, " of measuring at most, after the reference; --budget TIME ends it earlier"));
  // Most of it are rests, which take as long on every machine.
  const double seconds = std::stod(result.errors.substr(at + told.size()));
  CAPTURE(seconds, took);
  CHECK(seconds > took / 3.0);
  CHECK(seconds < took * 3.0);
  // What the store has costs no time.
  const CommandResult again = place.run("tune", {"slow"}, limits);
  INFO(again.errors);
  CHECK(contains(again.errors,
                 "4 of the first 4 in the store: how long further ones take is not known before"));
  CHECK(again.output == result.output);
}

TEST_CASE(
    "a search begins no point that would end beyond its budget, says how many, and the same command goes on") {
  const Place place;
  place.writeSlow("long", "1 2 3 4 5 6 7 8 9");
  std::vector<std::string> limits{"--frame-time",  "100s", "--output", "direct",
                                  "--evaluations", "9",    "--store",  place.file("r.sqlite")};
  const auto tuned = [&](const std::string& budget) {
    std::vector<std::string> more = limits;
    more.insert(more.end(), {"--budget", budget});
    return place.run("tune", {"long"}, more);
  };
  const CommandResult none = tuned("1ms");
  INFO(none.errors << none.output);
  CHECK(none.exitCode == 1);
  CHECK(contains(none.errors, "begun is what ends within 0 s (--budget)"));
  CHECK(contains(unwrapped(none.output),
                 "no time for 9 points: none would have ended in time; --budget 5s begins the shortest"));
  // Each time it goes on with what lacks.
  std::size_t before = 0, runs = 0;
  for (std::size_t left = 9; left > 0; ++runs) {
    REQUIRE(runs < 10);
    const auto begun = std::chrono::steady_clock::now();
    const CommandResult some = tuned("2500ms");
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    INFO(some.errors << some.output);
    REQUIRE(some.exitCode == 0);
    CHECK(seconds < 20.0);
    const std::string text = unwrapped(some.output);
    std::smatch measured;
    REQUIRE(std::regex_search(text, measured, std::regex("([0-9]+) points? measured")));
    const std::size_t points = std::stoul(measured[1]);
    CHECK(points > before);
    left = 9 - points;
    CHECK(contains(text, "no time for " + std::to_string(left) + " point") == (left > 0));
    CHECK(contains(text, "the same command goes on with them: lumivox --techniques") == (left > 0));
    before = points;
  }
  CHECK(runs > 1);
}

TEST_CASE("the lines below the table of a search fit the terminal") {
  const Place place;
  place.writeSlow("long", "1 2 3 4 5 6 7 8 9");
  const CommandResult result =
      runCommand("COLUMNS=80 " + (binaryDirectory() / "bin" / Place::program()).string() + "tune " +
                 place.quoted("room.scene") + " --pipeline " + place.quoted("fast.pipeline") +
                 " --pipeline " + place.quoted("long.pipeline") + Place::quick() +
                 "-q --frame-time 100s --budget 2500ms --evaluations 13 --store " + place.quoted("r.sqlite"));
  INFO(result.errors << result.output);
  REQUIRE(contains(unwrapped(result.output), "no time for "));
  std::istringstream lines(result.output.substr(result.output.find("limit 100000 ms")));
  for (std::string line; std::getline(lines, line);) {
    // A path is one word.
    if (std::count(line.begin(), line.end(), ' ') < 2) continue;
    INFO(line);
    CHECK(line.size() <= 80);
  }
}

TEST_CASE("contradicting or unknown wishes for tuning are refused") {
  const Tuning tuning;
  for (const auto& [options, facts] : std::vector<std::pair<const char*, Tells>>{
           {"", Tells("frame time", "error")},
           {"--frame-time 16ms --budget 30", Tells("--budget", 30, "unit")},
           {"--frame-time 16ms --budget 0s", Tells("--budget", "above", 0)},
           {"--frame-time 16ms --error 1", Tells("excludes")},
           {"--frame-time 16parsecs", Tells("--frame-time", "16parsecs", "16ms", "0.5s")},
           {"--frame-time -1ms", Tells("--frame-time", "above", 0)},
           {"--error 0", Tells("error", "above", 0)},
           {"--error 1 --metric flop", Tells("flop", "did you mean", "flip")},
           {"--error 1 --metric ssim", Tells("ssim", "expected one of")},
           {"--error 1 --output indirect", Tells("indirect", "expected one of")}}) {
    const CommandResult result = tuning.run(options);
    INFO(options << ": " << result.errors);
    CHECK(result.exitCode == 2);
    CHECK_THAT(result.errors, facts);
  }
}
