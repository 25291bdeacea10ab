#include <map>
#include <nlohmann/json.hpp>

#include "lumivox/analysis/interpolation.h"
#include "lumivox/base/file.h"
#include "support/support.h"

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
  CHECK(table.output.find("the best within 1000000 ms: direct, flip ") != std::string::npos);
  CHECK(table.output.find("\njudged: the whole image, flip against ") != std::string::npos);
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
      runCommand("lumivox results front --component direct --metric rmse --json --store " + tuning.store);
  INFO(front.errors);
  REQUIRE(front.exitCode == 0);
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
  CHECK(text.find("# of the area light") != std::string::npos);
  CHECK(runCommand("lumivox check " + best.string()).exitCode == 0);
  CHECK(runCommand("lumivox fmt --check " + best.string()).exitCode == 0);
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

TEST_CASE("contradicting or unknown wishes for tuning are refused") {
  const Tuning tuning;
  const auto refused = [&](const std::string& options, const std::string& part) {
    const CommandResult result = tuning.run(options);
    INFO(options << ": " << result.errors);
    CHECK(result.exitCode == 2);
    CHECK(result.errors.find(part) != std::string::npos);
  };
  refused("", "a frame time or an error");
  refused("--budget 16ms", "a budget is time for measuring; expected --frame-time 16ms");
  refused("--frame-time 16ms --error 1", "excludes");
  refused("--frame-time 16parsecs", "16ms or 0.5s");
  refused("--frame-time -1ms", "above 0");
  refused("--error 0", "above 0");
  refused("--error 1 --metric flop", "did you mean 'flip'");
  refused("--error 1 --metric ssim", "expected one of");
  refused("--error 1 --output indirect", "expected one of");
}
