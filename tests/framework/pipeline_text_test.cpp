// Pipeline texts without any technique library: what they say, and what is wrong in them.
#include "lumivox/base/log.h"
#include "lumivox/pipeline/pipeline.h"
#include "support/facts.h"
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

}  // namespace

TEST_CASE("a pipeline text gives its parameters, passes, outputs and sweeps") {
  const Pipeline pipeline = Pipeline::parse(kText, "a.pipeline");
  CHECK(pipeline.name == "Voxel cone tracing");
  REQUIRE(pipeline.parameters.size() == 3);
  const PipelineParameter &resolution = pipeline.parameters[0], &filter = pipeline.parameters[1];
  CHECK(resolution.name == "resolution");
  CHECK((resolution.value.number == 128.0 && resolution.low == 16.0 && resolution.high == 512.0));
  CHECK(filter.value.word == "fast");
  CHECK(filter.choices == std::vector<std::string>{"fast", "slow"});
  CHECK(pipeline.parameters[2].value.number == Approx(0.02));
  CHECK(pipeline.parameters[2].high == Approx(0.1));
  REQUIRE(pipeline.passes.size() == 2);
  const auto& gather = pipeline.passes[1];
  CHECK((gather.name == "gather" && gather.technique == "voxel_cone_tracing" && gather.pass == "gather"));
  CHECK(gather.place.line == 6);
  REQUIRE(pipeline.outputs.size() == 1);
  CHECK((pipeline.outputs[0].pass == "gather" && pipeline.outputs[0].port == "diffuse"));
  CHECK(pipeline.techniques() == std::vector<std::string>{"voxelization", "voxel_cone_tracing"});
  REQUIRE(pipeline.sweeps.size() == 1);
  std::vector<std::string> points;
  for (const auto& point : pipeline.sweeps[0].points())
    points.push_back(point.at("resolution").text() + " " + point.at("filter").word);
  CHECK(points == std::vector<std::string>{"32 fast", "32 slow", "64 fast", "64 slow"});
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
  const auto [setting, told] = GENERATE(table<const char*, Tells>({
      {"resolutoin=64", Tells("resolutoin", "resolution, filter, step", "mean", "resolution")},
      {"resolution=8", Tells("resolution", 8, "16..512")},
      {"resolution=many", Tells("resolution", "many", "number", "16..512")},
      {"resolution=nan", Tells("number")},
      {"resolution=64 } pass", Tells("number")},
      {"resolution=", Tells("number")},
      {"filter=medium", Tells("filter", "medium", "fast, slow")},
      {"step=5 s", Tells("length")},
      {"step", Tells("NAME=VALUE")},
      {"=5", Tells("NAME=VALUE")},
  }));
  CAPTURE(setting);
  CHECK_THROWS_MATCHES(Pipeline::parse(kText, "a.pipeline").settings({setting}), Error, told);
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
  CHECK_THAT(text,
             Tells("a.pipeline:2:14", "size", 4, "16..32", "a.pipeline:4:8", "second", "a", "a.pipeline:3:8",
                   "a.pipeline:5:3", "outptu", "mean", "output", "a.pipeline:7:11", "sise", "mean", "size"));
  CHECK_THAT(text, Catch::Contains("\n    outptu x a.b\n    ^~~~~~"));
}

TEST_CASE("each mistake in the blocks of a pipeline is told with what was expected") {
  const auto [body, told] = GENERATE(table<const char*, Tells>({
      {"output x a.b\noutput x a.c", Tells("a.pipeline:3:8", "second", "x")},
      {"output x 5", Tells("output", "output NAME pass.port")},
      {"output x a.b.c", Tells("output of a pass")},
      {"param n 1\nparam n 2", Tells("second", "n")},
      {"param n", Tells("param", "param NAME DEFAULT in LOW..HIGH")},
      {"param n 1 cm in 1..2 s", Tells("range", "time", "length")},
      {"pass b { }", Tells("pass", "name")},
      {"pass b one { }", Tells("technique", "passes")},
      {"pass b folder/evil.pass { }", Tells("technique", "passes")},
      {"pas b t.p { }", Tells("block", "pas", "mean", "pass")},
  }));
  CAPTURE(body);
  CHECK_THAT(findingsOf(std::string("pipeline \"p\" {\n") + body + "\npass a t.p { }\noutput o a.x\n}\n"),
             told);
}

TEST_CASE("a text without a pipeline, with two, or with one of no pass is refused") {
  const auto [text, told] = GENERATE(table<const char*, Tells>({
      {"pipline \"p\" { }\n", Tells("block", "pipline", "mean", "pipeline")},
      {"sweep s { n [1] }\n", Tells("no pipeline")},
      {"# nothing\n", Tells("a.pipeline")},
      {"pipeline \"a\" { }\npipeline \"b\" { }\n", Tells("a.pipeline:2:1", "second")},
      {"pipeline \"a\" { }\n", Tells("no pass")},
  }));
  CHECK_THAT(findingsOf(text), told);
}

TEST_CASE("sweep values outside the declared range of their parameter are refused") {
  CHECK_THAT(findingsOf("pipeline \"p\" {\n  param n 20 in 16..32\n  pass a t.p { n $n }\n  output o a.x\n}\n"
                        "sweep s { n [16 64] }\nsweep s { n [] }\nsweep r { n 16 }\n"),
             Tells("a.pipeline:6:17", "n", "16..32") && Tells("second", "s") &&
                 Tells("a.pipeline:8:11", "list", "n [a b c]"));
}

TEST_CASE("a parameter that no pass uses is a warning, not an error") {
  const LogCapture log;
  const Pipeline pipeline =
      Pipeline::parse("pipeline \"p\" {\n  param n 1\n  pass a t.p { }\n  output o a.x\n}\n", "a.pipeline");
  CHECK(pipeline.parameters.size() == 1);
  CHECK_THAT(log.text(), Tells("a.pipeline:2:9", "warning", "n"));
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

TEST_CASE("the tables of the pipeline grammar describe every word of it") {
  for (const char* word : {"pipeline", "param", "pass", "output", "sweep"}) {
    CHECK_THAT(dsl::describe(pipelineSpecifications(), word), Tells(word));
  }
}
