// Sweeps in the texts: grids, lists, steps, seeds, and texts of sweeps alone.
#include <cmath>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/sweep_text.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Contains;

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
std::vector<std::string> valuesOf(const std::string& axis) {
  const Pipeline pipeline = withSweep("sweep s { " + axis + " }\n");
  std::vector<std::string> values;
  for (const ParameterValue& value : pipeline.sweeps.at(0).axes.at(0).second) values.push_back(value.text());
  return values;
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

TEST_CASE(
    "steps multiply or add from the lower end up to the upper one, which belongs to them when they meet it") {
  using Texts = std::vector<std::string>;
  CHECK(valuesOf("n times 2 in 8..64") == Texts{"8", "16", "32", "64"});
  CHECK(valuesOf("n times 2 in 6..47") == Texts{"6", "12", "24"});
  CHECK(valuesOf("n plus 3 in 1..10") == Texts{"1", "4", "7", "10"});
  // A tenth is no binary fraction, but nobody wants to read 0.30000000000000004.
  CHECK(valuesOf("x plus 0.1 in 0..0.5") == Texts{"0", "0.1", "0.2", "0.3", "0.4", "0.5"});
  CHECK(valuesOf("d plus 1 cm in 1..3 cm") == Texts{"0.01", "0.02", "0.03"});
  CHECK(valuesOf("n times 2 in 5..5") == Texts{"5"});
}

TEST_CASE("steps that never end, run backwards or mix units are refused at their place") {
  CHECK_THAT(findingsOf("sweep s { n times 1 in 1..8 }\n"),
             Contains("a.pipeline:8:19: these steps never reach"));
  CHECK_THAT(findingsOf("sweep s { n plus 0 in 1..8 }\n"), Contains("a step above 0"));
  CHECK_THAT(findingsOf("sweep s { x times 2 in 0..1 }\n"), Contains("a lower end above 0"));
  CHECK_THAT(findingsOf("sweep s { n plus 1 in 8..1 }\n"),
             Contains("a.pipeline:8:23: the range runs backwards"));
  CHECK_THAT(findingsOf("sweep s { d plus 1 in 1..3 cm }\n"), Contains("different units"));
  CHECK_THAT(findingsOf("sweep s { n times 2 }\n"), Contains("expected n times 2 in LOW..HIGH"));
  CHECK_THAT(findingsOf("sweep s { x plus 0.00001 in 0..1 }\n"),
             Contains("too many steps; expected at most 4096"));
  // A step beyond the parameter's range is one finding, not one for each value.
  const std::string beyond = findingsOf("sweep s { n times 2 in 32..256 }\n");
  CHECK_THAT(beyond, Contains("this value does not fit the parameter 'n'; expected a number in 1..64"));
  CHECK(beyond.find("does not fit") == beyond.rfind("does not fit"));
}

TEST_CASE("seeds of a sweep are whole numbers, each once, beside parameters or alone") {
  const Pipeline pipeline = withSweep("sweep s { seeds [7 3]  n [1 2] }\nsweep t { seeds [1] }\n");
  CHECK(pipeline.sweeps[0].seeds == std::vector<std::uint64_t>{7, 3});
  CHECK(pipeline.sweeps[0].points().size() == 2);
  REQUIRE(pipeline.sweeps[1].points().size() == 1);
  CHECK(pipeline.sweeps[1].points()[0].empty());
  const std::string wrong = findingsOf("sweep s { seeds [1 1 -2 0.5 many] }\n");
  CHECK_THAT(wrong, Contains("a.pipeline:8:20: the seed 1 is given twice"));
  CHECK_THAT(wrong, Contains("a.pipeline:8:22: this is not a seed"));
  CHECK_THAT(wrong, Contains("a.pipeline:8:25: this is not a seed"));
  CHECK_THAT(wrong, Contains("a.pipeline:8:29: this is not a seed"));
}

TEST_CASE("a list of unequal axes, an unknown kind and a sweep with too many points are refused") {
  CHECK_THAT(findingsOf("sweep s list { n [1 2 4]  x [0.1 0.2] }\n"),
             Contains("a.pipeline:8:27: 'x' has 2 values, but 'n' has 3"));
  CHECK_THAT(findingsOf("sweep s lists { n [1] }\n"), Contains("did you mean 'list'"));
  CHECK_THAT(findingsOf("sweep { n [1] }\n"), Contains("a sweep needs one name"));
  CHECK_THAT(findingsOf("sweep s { x plus 0.001 in 0..1  d plus 0.00025 in 0.01..0.5 }\n"),
             Contains("points; expected at most 131072"));
}

TEST_CASE("a pipeline names no scenes, and no parameter takes a word of sweeps") {
  CHECK_THAT(findingsOf("sweep s { scenes [\"a.scene\"]  n [1] }\n"), Contains("a pipeline names no scenes"));
  const std::string reserved = test::messageOf<DiagnosticsError>([] {
    Pipeline::parse("pipeline \"P\" {\n  param seeds 1\n  pass a t.p { n $seeds }\n}\n", "a.pipeline");
  });
  CHECK_THAT(reserved, Contains("a.pipeline:2:9: 'seeds' is a reserved word of sweeps"));
}

TEST_CASE("accumulated frames are an axis of every pipeline, of whole numbers from 1 on, and no parameter") {
  CHECK(valuesOf("frames times 2 in 1..8") == std::vector<std::string>{"1", "2", "4", "8"});
  const auto points = withSweep("sweep s { frames [1 16]  n [1 2] }\n").sweeps.at(0).points();
  REQUIRE(points.size() == 4);
  CHECK(points[2].at("frames").number == 16.0);
  CHECK_THAT(
      findingsOf("sweep s { frames [0] }\n"),
      Contains("a.pipeline:8:19: this value does not fit the parameter 'frames'") && Contains("1..65536"));
  CHECK_THAT(findingsOf("sweep s { frames [1 2.5] }\n"), Contains("a whole number"));
  CHECK_THAT(findingsOf("sweep s { frames [2 s] }\n"), Contains("does not fit the parameter 'frames'"));
  CHECK_THAT(findingsOf("sweep s { frames [many] }\n"), Contains("does not fit the parameter 'frames'"));
  const std::string reserved = test::messageOf<DiagnosticsError>([] {
    Pipeline::parse("pipeline \"P\" {\n  param frames 1\n  pass a t.p { n $frames }\n}\n", "a.pipeline");
  });
  CHECK_THAT(reserved, Contains("a.pipeline:2:9: 'frames' is a reserved word of sweeps"));
}

TEST_CASE("the table of the sweep texts has the words that the reader knows") {
  const std::vector<std::string> words = dsl::words(sweepSpecifications());
  CHECK(std::set<std::string>(words.begin(), words.end()) ==
        std::set<std::string>{"sweep", kSweptScenes, kSweptPipelines, kSweptSeeds});
}
