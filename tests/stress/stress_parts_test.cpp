// The parts of the stress battery: which technique a pipeline stands for, explanations in cards, parameters
// of passes, processes.
#include <algorithm>
#include <chrono>

#include "lumivox/base/error.h"
#include "lumivox/stress/stress.h"
#include "stress/cards.h"
#include "stress/child.h"
#include "stress/pass_parameters.h"
#include "stress/protocol.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::stress;
using namespace lumivox::test;

namespace {

Pipeline named(const std::string& file, const std::string& body) {
  return Pipeline::parse("pipeline \"test\" {\n" + body + "\n}\n", file);
}

constexpr const char* kSeen =
    "  pass gbuffer direct_lighting.gbuffer { }\n  pass shadow direct_lighting.shadow_map { size 64 }\n"
    "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n"
    "  pass lights reflective_shadow_maps.render { }\n"
    "  pass gather reflective_shadow_maps.gather { gbuffer gbuffer  map lights.map }\n";

}  // namespace

TEST_CASE(
    "a pipeline stands for the technique that its name begins with, else for the one behind its light") {
  const auto subject = [](const std::string& file, const std::string& outputs) {
    return techniqueOf(named(file, kSeen + outputs), techniques());
  };
  const std::string both = "  output direct direct.radiance\n  output indirect gather.diffuse";
  CHECK(subject("mine.pipeline", both) == "reflective_shadow_maps");
  CHECK(subject("direct_lighting.pipeline", both) == "direct_lighting");
  CHECK(subject("direct_lighting_and_more.pipeline", both) == "direct_lighting");
  CHECK(subject("mine.pipeline", "  output direct direct.radiance") == "direct_lighting");
  CHECK(subject("mine.pipeline", "") == "reflective_shadow_maps");  // its last pass
  for (const char* file : {"voxelisers/points", "voxelisers/reproject", "voxelisers/solid"})
    CHECK(techniqueOf(pipeline(file), techniques()) == "voxelization");
  CHECK(techniqueOf(pipeline("light_propagation_volumes_voxels"), techniques()) ==
        "light_propagation_volumes");
  CHECK(techniqueOf(pipeline("volumetric_smoke"), techniques()) == "volumetric_smoke");
}

TEST_CASE("a card's table below its heading explains cases, by patterns and for single pipelines") {
  const std::vector<CardRow> rows = whereItBreaks(
      "# A card\n| case | what | why |\n|---|---|---|\n| other | x | y |\n\n## Where it breaks\n\nText.\n\n"
      "| case | what happens | why |\n|---|---|---|\n| `thin_wall`, `points/*_lowest` | it leaks | no sides |\n"
      "| moved_* | shifts | grid |\n\n## Limits\n\n| a | b | c |\n|---|---|---|\n| thin_wall | no | no |\n");
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].what == "it leaks");
  CHECK(rows[0].why == "no sides");
  CHECK(rowFor(rows, "anything", "thin_wall") == rows.data());
  CHECK(rowFor(rows, "anything", "thin_walls") == nullptr);
  CHECK(rowFor(rows, "points", "resolution_lowest") == rows.data());
  CHECK(rowFor(rows, "slicing", "resolution_lowest") == nullptr);
  CHECK(rowFor(rows, "anything", "moved_far") == rows.data() + 1);
  // What speaks of one pipeline goes before what speaks of all, wherever it stands.
  const std::vector<CardRow> both{{{"thin_wall"}, "all", ""}, {{"points/thin_*"}, "one", ""}};
  CHECK(rowFor(both, "points", "thin_wall")->what == "one");
  CHECK(rowFor(both, "slicing", "thin_wall")->what == "all");
  CHECK(whereItBreaks("## Where it breaks\n| case | what | why |\n").empty());
  CHECK(whereItBreaks("").empty());
}

TEST_CASE("parameters of passes that a text leaves free are found and set") {
  const Pipeline text =
      named("mine.pipeline", std::string("  param samples 100 in 1..200\n") +
                                 "  pass gbuffer direct_lighting.gbuffer { }\n"
                                 "  pass shadow direct_lighting.shadow_map { size 64 }\n"
                                 "  pass lights reflective_shadow_maps.render { }\n"
                                 "  pass gather reflective_shadow_maps.gather { gbuffer gbuffer  "
                                 "map lights.map  samples $samples }\n"
                                 "  output indirect gather.diffuse");
  const std::vector<PassParameter> free = freePassParameters(text, techniques());
  const auto find = [&](const std::string& name) {
    return std::find_if(free.begin(), free.end(), [&](const PassParameter& one) { return one.name == name; });
  };
  REQUIRE(find("shadow.size") != free.end());
  CHECK(find("shadow.size")->value == "64");
  CHECK(find("shadow.size")->low == 16);
  CHECK(find("gather.samples") == free.end());  // a parameter of the pipeline stands for it

  ParameterValues values;
  values["shadow.size"].number = 32;
  values["lights.area_samples"].number = 3;
  const Pipeline set = withPassParameters(text, values);
  const std::vector<PassParameter> now = freePassParameters(set, techniques());
  const auto valueOf = [&](const std::string& name) {
    return std::find_if(now.begin(), now.end(), [&](const PassParameter& one) { return one.name == name; })
        ->value;
  };
  CHECK(valueOf("shadow.size") == "32");
  CHECK(valueOf("lights.area_samples") == "3");
  CHECK_NOTHROW(checkPipeline(set, techniques()));
  ParameterValues unknown;
  unknown["absent.size"].number = 1;
  CHECK(messageOf<Error>([&] { withPassParameters(text, unknown); }).find("absent.size") !=
        std::string::npos);
}

TEST_CASE("requests to a worker come back as they were written") {
  ContentRequest request{"a.pipeline", "cornell", true, {}};
  request.shot.width = 7;
  request.shot.time = 0.25;
  request.shot.parameters["quality"].word = "high";
  request.shot.passParameters["gather.cones"].number = 5;
  const AnyRequest back = requestOf(lineOf(request));
  REQUIRE(back.content);
  CHECK_FALSE(back.cell);
  CHECK(back.content->committedScene == "cornell");
  CHECK(back.content->shot.width == 7);
  CHECK(back.content->shot.time == 0.25);
  CHECK(back.content->shot.parameters == request.shot.parameters);
  CHECK(back.content->shot.passParameters == request.shot.passParameters);
  CHECK(lineOf(*requestOf(lineOf(CellRequest{"b.pipeline", "a_case", false, "c.png"})).cell) ==
        lineOf(CellRequest{"b.pipeline", "a_case", false, "c.png"}));
  CHECK(messageOf<Error>([] { requestOf("{}"); }).find("no request") != std::string::npos);
}

TEST_CASE("a child answers line by line, tells how it ended, and dies with what it started") {
  {
    Child cat({"/bin/cat"}, {});
    cat.send("one");
    cat.send("two");
    CHECK(cat.receive(10.0).line == "one");
    CHECK(cat.receive(10.0).line == "two");
    CHECK(cat.receive(0.05).state == Child::State::silent);
  }
  Child shell({"/bin/sh", "-c", "echo \"$GREETING\"; echo lost >&2; kill -9 $$"}, {"GREETING=hello"});
  CHECK(shell.receive(10.0).line == "hello");
  CHECK(shell.receive(10.0).state == Child::State::ended);
  CHECK(shell.ending().find("killed by signal 9") != std::string::npos);
  CHECK(shell.lastWords() == "lost");
  shell.send("nobody hears");  // and nobody is killed by it

  // A grandchild that holds the pipe open, and would for a minute.
  const auto start = std::chrono::steady_clock::now();
  { Child nested({"/bin/sh", "-c", "sleep 60 & sleep 60"}, {}); }
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
  CHECK(messageOf<Error>([] { Child({"/no/such/program"}, {}); }).find("/no/such/program") !=
        std::string::npos);
}
