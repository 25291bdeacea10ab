// Sweeps in the texts: grids, lists, steps, seeds, and texts of sweeps alone.
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/sweep_text.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using lumivox::test::Tells;

namespace {

constexpr const char* kPipeline =
    "pipeline \"P\" {\n"
    "  param n 4 in 1..64\n"
    "  param x 0.5 in 0..1\n"
    "  param d 2 cm in 1..50 cm\n"
    "  param word fast in [fast slow]\n"
    "  pass a t.p { n $n  x $x  d $d  word $word }\n"
    "}\n";

Pipeline withSweep(const std::string& sweep) {
  return Pipeline::parse(kPipeline + sweep, "a.pipeline");
}
std::string findingsOf(const std::string& sweep) {
  return test::messageOf<DiagnosticsError>([&] { withSweep(sweep); });
}

}  // namespace

TEST_CASE("a list sweep has the points along its lists, and one value holds for all of them") {
  const Pipeline pipeline = withSweep("sweep s list { n [1 2 4]  x [0.1 0.2 0.3]  word [slow] }\n");
  REQUIRE(pipeline.sweeps.size() == 1);
  const auto points = pipeline.sweeps[0].points();
  REQUIRE(points.size() == 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK(points[i].at("n").number == std::pow(2.0, i));
    CHECK(points[i].at("x").number == Approx(0.1 * (static_cast<double>(i) + 1)));
    CHECK(points[i].at("word").word == "slow");
  }
  CHECK(withSweep("sweep s grid { n [1 2 4]  x [0.1 0.2] }\n").sweeps[0].points().size() == 6);
}

TEST_CASE("steps multiply or add from the lower end to the upper, inclusive when they meet it") {
  const auto [axis, values] = GENERATE(table<const char*, const char*>({
      {"n times 2 in 8..64", "8 16 32 64 "},
      {"n times 2 in 6..47", "6 12 24 "},
      {"n times 2 in 5..5", "5 "},
      {"n plus 3 in 1..10", "1 4 7 10 "},
      {"x plus 0.1 in 0..0.5", "0 0.1 0.2 0.3 0.4 0.5 "},  // none of 0.30000000000000004
      {"d plus 1 cm in 1..3 cm", "0.01 0.02 0.03 "},
      {"frames times 2 in 1..8", "1 2 4 8 "},  // accumulated frames are an axis of every pipeline
  }));
  const Pipeline pipeline = withSweep(fmt::format("sweep s {{ {} }}\n", axis));
  std::string found;
  for (const ParameterValue& value : pipeline.sweeps.at(0).axes.at(0).second) found += value.text() + " ";
  CHECK(found == values);
}

TEST_CASE("each mistake in a sweep is told at its place") {
  const auto [sweep, told] = GENERATE(table<const char*, Tells>({
      {"sweep s { n times 1 in 1..8 }", Tells("a.pipeline:8:19", "never")},
      {"sweep s { n plus 0 in 1..8 }", Tells("step", "above 0")},
      {"sweep s { x times 2 in 0..1 }", Tells("lower end", "above 0")},
      {"sweep s { n plus 1 in 8..1 }", Tells("a.pipeline:8:23", "backwards")},
      {"sweep s { d plus 1 in 1..3 cm }", Tells("units")},
      {"sweep s { n times 2 }", Tells("n times 2 in LOW..HIGH")},
      {"sweep s { x plus 0.00001 in 0..1 }", Tells("steps", 4096)},
      {"sweep s { seeds [1 1 -2 0.5 many] }", Tells("a.pipeline:8:20", "seed", 1, "twice", "a.pipeline:8:22",
                                                    "a.pipeline:8:25", "a.pipeline:8:29", "seed")},
      {"sweep s list { n [1 2 4]  x [0.1 0.2] }", Tells("a.pipeline:8:27", "x", 2, "n", 3)},
      {"sweep s lists { n [1] }", Tells("mean", "list")},
      {"sweep { n [1] }", Tells("one name")},
      {"sweep s { x plus 0.001 in 0..1  d plus 0.00025 in 0.01..0.5 }", Tells("points", 131072)},
      {"sweep s { scenes [\"a.scene\"]  n [1] }", Tells("no scenes")},
      {"sweep s { frames [0] }", Tells("a.pipeline:8:19", "frames", "1..65536")},
      {"sweep s { frames [1 2.5] }", Tells("whole")},
      {"sweep s { frames [2 s] }", Tells("fit", "frames")},
      {"sweep s { frames [many] }", Tells("fit", "frames")},
  }));
  CAPTURE(sweep);
  CHECK_THAT(findingsOf(std::string(sweep) + "\n"), told);
  // A step beyond the parameter's range is one finding, not one for each value.
  const std::string beyond = findingsOf("sweep s { n times 2 in 32..256 }\n");
  CHECK_THAT(beyond, Tells("fit", "n", "1..64"));
  CHECK(beyond.find("does not fit") == beyond.rfind("does not fit"));
}

TEST_CASE("seeds of a sweep stand beside parameters or alone, and accumulated frames beside parameters") {
  const Pipeline pipeline = withSweep(
      "sweep s { seeds [7 3]  n [1 2] }\nsweep t { seeds [1] }\nsweep u { frames [1 16]  n [1 2] }\n");
  CHECK(pipeline.sweeps[0].seeds == std::vector<std::uint64_t>{7, 3});
  CHECK(pipeline.sweeps[0].points().size() == 2);
  REQUIRE(pipeline.sweeps[1].points().size() == 1);
  CHECK(pipeline.sweeps[1].points()[0].empty());
  REQUIRE(pipeline.sweeps[2].points().size() == 4);
  CHECK(pipeline.sweeps[2].points()[2].at("frames").number == 16.0);
}

TEST_CASE("no parameter takes a word of sweeps") {
  const std::string word = GENERATE("seeds", "frames");
  CHECK_THROWS_MATCHES(
      Pipeline::parse("pipeline \"P\" {\n  param " + word + " 1\n  pass a t.p { n $" + word + " }\n}\n",
                      "a.pipeline"),
      DiagnosticsError, Tells("a.pipeline:2:9", word, "reserved"));
}

TEST_CASE("the table of the sweep texts has the words that the reader knows") {
  const std::vector<std::string> words = dsl::words(sweepSpecifications());
  CHECK(std::set<std::string>(words.begin(), words.end()) ==
        std::set<std::string>{"sweep", kSweptScenes, kSweptPipelines, kSweptSeeds});
}
