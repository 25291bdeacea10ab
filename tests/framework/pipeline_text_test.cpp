// Pipeline texts without any technique library: what they say, and what is wrong in them.
#include "lumivox/base/log.h"
#include "lumivox/pipeline/pipeline.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

const char* const kText = R"(pipeline "Voxel cone tracing" {
  param resolution 128 in 16..512
  param filter fast in [fast slow]
  param step 2 cm in 1..10 cm
  pass voxels voxelization.conservative { resolution $resolution  filter $filter  step $step }
  pass gather voxel_cone_tracing.gather { grid voxels.fragments }
  output diffuse gather.diffuse
}
sweep quality { resolution [32 64]  filter [fast slow] }
)";

std::string findingsOf(const std::string& text) {
  return messageOf<DiagnosticsError>([&] { Pipeline::parse(text, "a.pipeline"); });
}

std::string findingsOfBody(const std::string& body) {
  return findingsOf("pipeline \"p\" {\n" + body + "\npass a t.p { }\noutput o a.x\n}\n");
}

}  // namespace

TEST_CASE("a pipeline text gives its parameters, passes, outputs and sweeps") {
  const Pipeline pipeline = Pipeline::parse(kText, "a.pipeline");
  CHECK(pipeline.name == "Voxel cone tracing");
  REQUIRE(pipeline.parameters.size() == 3);
  CHECK(pipeline.parameters[0].name == "resolution");
  CHECK(pipeline.parameters[0].value.number == 128.0);
  CHECK(pipeline.parameters[0].low == 16.0);
  CHECK(pipeline.parameters[0].high == 512.0);
  CHECK(pipeline.parameters[1].value.word == "fast");
  CHECK(pipeline.parameters[1].choices == std::vector<std::string>{"fast", "slow"});
  CHECK(pipeline.parameters[2].value.number == Approx(0.02));
  CHECK(pipeline.parameters[2].high == Approx(0.1));
  REQUIRE(pipeline.passes.size() == 2);
  CHECK(pipeline.passes[1].name == "gather");
  CHECK(pipeline.passes[1].technique == "voxel_cone_tracing");
  CHECK(pipeline.passes[1].pass == "gather");
  CHECK(pipeline.passes[1].place.line == 6);
  REQUIRE(pipeline.outputs.size() == 1);
  CHECK(pipeline.outputs[0].pass == "gather");
  CHECK(pipeline.outputs[0].port == "diffuse");
  CHECK(pipeline.techniques() == std::vector<std::string>{"voxelization", "voxel_cone_tracing"});
}

TEST_CASE("a sweep is the grid over its lists, the last list fastest") {
  const Pipeline pipeline = Pipeline::parse(kText, "a.pipeline");
  REQUIRE(pipeline.sweeps.size() == 1);
  const auto points = pipeline.sweeps[0].points();
  REQUIRE(points.size() == 4);
  CHECK(points[0].at("resolution").number == 32.0);
  CHECK(points[0].at("filter").word == "fast");
  CHECK(points[1].at("filter").word == "slow");
  CHECK(points[2].at("resolution").number == 64.0);
}

TEST_CASE("settings are read like values of the text, with units, words and ranges") {
  const Pipeline pipeline = Pipeline::parse(kText, "a.pipeline");
  const ParameterValues values = pipeline.settings({"resolution=64", "filter=slow", "step=5 cm"});
  CHECK(values.size() == 3);
  CHECK(values.at("resolution").number == 64.0);
  CHECK(values.at("filter").word == "slow");
  CHECK(values.at("step").number == Approx(0.05));
  CHECK(pipeline.settings({}).empty());
  // The printed form of a value can be given again.
  CHECK(pipeline.settings({"step=" + values.at("step").text()}) ==
        ParameterValues{{"step", values.at("step")}});
}

TEST_CASE("a setting that does not fit is refused with the accepted values") {
  const Pipeline pipeline = Pipeline::parse(kText, "a.pipeline");
  const auto refused = [&](const std::string& setting) {
    return messageOf<Error>([&] { pipeline.settings({setting}); });
  };
  CHECK_THAT(refused("resolutoin=64"), Contains("no parameter 'resolutoin'") &&
                                           Contains("resolution, filter, step") &&
                                           Contains("did you mean 'resolution'?"));
  CHECK_THAT(refused("resolution=8"), Contains("must be a number in 16..512"));
  CHECK_THAT(refused("resolution=many"), Contains("must be a number in 16..512"));
  CHECK_THAT(refused("resolution=nan"), Contains("must be a number"));
  CHECK_THAT(refused("resolution=64 } pass"), Contains("must be a number"));
  CHECK_THAT(refused("filter=medium"), Contains("must be one of fast, slow"));
  CHECK_THAT(refused("step=5 s"), Contains("measures length"));
  CHECK_THAT(refused("step"), Contains("expected NAME=VALUE"));
  CHECK_THAT(refused("=5"), Contains("expected NAME=VALUE"));
  CHECK_THAT(refused("resolution="), Contains("must be a number"));
}

TEST_CASE("all findings of a pipeline text are reported at once, each with its place") {
  const std::string text = findingsOf(
      "pipeline \"p\" {\n"
      "  param size 4 in 16..32\n"
      "  pass a one.two { }\n"
      "  pass a one.two { }\n"
      "  outptu x a.b\n"
      "}\n"
      "sweep s { sise [1 2] }\n");
  CHECK_THAT(
      text,
      Contains(
          "a.pipeline:2:14: the default of 'size' is 4, which does not fit; expected a number in 16..32"));
  CHECK_THAT(
      text,
      Contains(
          "a.pipeline:4:8: a second pass named 'a'; expected another name; the first is at a.pipeline:3:8"));
  CHECK_THAT(text, Contains("a.pipeline:5:3: unknown property 'outptu' in a pipeline") &&
                       Contains("did you mean 'output'?"));
  CHECK_THAT(text, Contains("a.pipeline:7:11: unknown parameter 'sise'") && Contains("did you mean 'size'?"));
  CHECK_THAT(text, Contains("\n    outptu x a.b\n    ^~~~~~"));
}

TEST_CASE("two outputs of one name are refused") {
  CHECK_THAT(findingsOfBody("output x a.b\noutput x a.c"),
             Contains("a.pipeline:3:8: a second output named 'x'"));
}

TEST_CASE("two parameters of one name are refused") {
  CHECK_THAT(findingsOfBody("param n 1\nparam n 2"), Contains("a second parameter named 'n'"));
}

TEST_CASE("a pass without technique and name is refused") {
  CHECK_THAT(findingsOfBody("pass b { }"),
             Contains("a pass needs its own name and that of a technique's pass"));
  CHECK_THAT(findingsOfBody("pass b one { }"), Contains("a technique and one of its passes are needed here"));
  CHECK_THAT(findingsOfBody("pass b folder/evil.pass { }"),
             Contains("a technique and one of its passes are needed here"));
}

TEST_CASE("a parameter without a value is refused") {
  CHECK_THAT(findingsOfBody("param n"),
             Contains("malformed param; expected param NAME DEFAULT in LOW..HIGH"));
}

TEST_CASE("a range in another unit than the default is refused") {
  CHECK_THAT(findingsOfBody("param n 1 cm in 1..2 s"),
             Contains("the range has a unit of time; expected a unit of length, as the default"));
}

TEST_CASE("an output that names no output of a pass is refused") {
  CHECK_THAT(findingsOfBody("output x 5"), Contains("malformed output; expected output NAME pass.port"));
  CHECK_THAT(findingsOfBody("output x a.b.c"), Contains("this is not an output of a pass"));
}

TEST_CASE("an unknown block in a pipeline text is refused with the nearest known one") {
  CHECK_THAT(findingsOf("pipline \"p\" { }\n"),
             Contains("unknown block 'pipline'") && Contains("did you mean 'pipeline'?"));
  CHECK_THAT(findingsOfBody("pas b t.p { }"),
             Contains("unknown block 'pas' in a pipeline") && Contains("did you mean 'pass'?"));
}

TEST_CASE("a text without a pipeline, or with two, is refused") {
  CHECK_THAT(findingsOf("sweep s { n [1] }\n"), Contains("the text has no pipeline block"));
  CHECK_THAT(findingsOf("# nothing\n"), Contains("a.pipeline"));
  CHECK_THAT(findingsOf("pipeline \"a\" { }\npipeline \"b\" { }\n"),
             Contains("a.pipeline:2:1: a second pipeline in one text"));
  CHECK_THAT(findingsOf("pipeline \"a\" { }\n"), Contains("the pipeline has no pass"));
}

TEST_CASE("sweep values outside the declared range of their parameter are refused") {
  const std::string text = findingsOf(
      "pipeline \"p\" {\n  param n 20 in 16..32\n  pass a t.p { n $n }\n  output o a.x\n}\n"
      "sweep s { n [16 64] }\nsweep s { n [] }\nsweep r { n 16 }\n");
  CHECK_THAT(
      text,
      Contains("a.pipeline:6:17: this value does not fit the parameter 'n'; expected a number in 16..32"));
  CHECK_THAT(text, Contains("a second sweep named 's'"));
  CHECK_THAT(text, Contains("a.pipeline:8:11: a sweep needs a list of values; expected n [a b c]"));
}

TEST_CASE("a parameter that no pass uses is a warning, not an error") {
  const LogCapture log;
  const Pipeline pipeline =
      Pipeline::parse("pipeline \"p\" {\n  param n 1\n  pass a t.p { }\n  output o a.x\n}\n", "a.pipeline");
  CHECK(pipeline.parameters.size() == 1);
  CHECK_THAT(log.text(), Contains("a.pipeline:2:9: warning: no pass uses the parameter 'n'"));
}

TEST_CASE("a pipeline text may include another, which changes its hash") {
  const TemporaryDirectory directory;
  directory.write("view.pipeline", "pass view t.p { }\n");
  const auto file = directory.write("main.pipeline",
                                    "pipeline \"p\" {\n  include \"view.pipeline\"\n  output o view.x\n}\n");
  const Pipeline before = Pipeline::load(file);
  REQUIRE(before.passes.size() == 1);
  CHECK(before.passes[0].name == "view");
  directory.write("view.pipeline", "pass view t.q { }\n");
  CHECK_FALSE(Pipeline::load(file).hash == before.hash);
}

TEST_CASE("a missing pipeline file is an error that names it") {
  const TemporaryDirectory directory;
  CHECK_THAT(messageOf<Error>([&] { Pipeline::load(directory.path() / "absent.pipeline"); }),
             Contains("absent.pipeline"));
}

TEST_CASE("the tables of the pipeline grammar describe every word of it") {
  for (const char* word : {"pipeline", "param", "pass", "output", "sweep"}) {
    CHECK_THAT(dsl::describe(pipelineSpecifications(), word), Contains(word));
  }
}
