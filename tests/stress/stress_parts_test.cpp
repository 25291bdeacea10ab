// The parts of the stress battery: which technique a pipeline stands for, explanations in cards, parameters
// of passes, processes.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <sstream>

#include "base/child.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/stress_cells.h"
#include "lumivox/stress/stress.h"
#include "stress/cards.h"
#include "stress/pass_parameters.h"
#include "stress/protocol.h"
#include "support/facts.h"
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

/// A program that answers every request with the same cell, and does as it is told otherwise.
class FalseWorkers {
 public:
  /// `script` is run by a shell for each line; $START is the number of the worker, from 1 on.
  explicit FalseWorkers(const std::string& onStart, const std::string& script, bool software = true) {
    StressCell cell;
    cell.device = "a device";
    cell.outcome = StressOutcome::stable;
    cell.detail = "answered";
    directory_.write("cell.json", stressCellJson(cell) + "\n");
    directory_.write("ready.json", lineOf(WorkerDevice{"a device", "a driver", "spirv", software}) + "\n");
    const std::string here = directory_.path().string();
    directory_.write("worker.sh", "echo \"$*\" >> '" + here + "/starts'\nSTART=$(wc -l < '" + here +
                                      "/starts')\n" + "answer() { cat '" + here + "/cell.json'; }\n" +
                                      onStart + "\ncat '" + here + "/ready.json'\nwhile read -r line; do\n" +
                                      script + "\ndone\n");
    options.program = {"/bin/sh", (directory_.path() / "worker.sh").string()};
    options.quick = true;
    options.pipelines = {sourceDirectory() / "scenes/pipelines/direct_lighting.pipeline"};
    options.families = {"light"};
    options.store = directory_.path() / "cells.sqlite";
  }
  std::vector<StressCell> run() { return runStress(options, techniques()).cells; }
  std::vector<StressCell> stored() const {
    return ResultsStore(options.store, ResultsStore::Mode::read).stressCells();
  }
  std::vector<std::string> starts() const {
    std::vector<std::string> lines;
    std::istringstream stream(readFile(directory_.path() / "starts"));
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }
  StressOptions options;

 private:
  TemporaryDirectory directory_;
};

std::ptrdiff_t brokenOf(const std::vector<StressCell>& cells) {
  return std::count_if(cells.begin(), cells.end(),
                       [](const StressCell& cell) { return cell.outcome == StressOutcome::broken; });
}

}  // namespace

TEST_CASE("a pipeline stands for the technique of its name, else for that behind its light") {
  const auto subject = [](const std::string& file, const std::string& outputs) {
    return techniqueOf(named(file, kSeen + outputs), techniques());
  };
  const std::string both = "  output direct direct.radiance\n  output indirect gather.diffuse";
  CHECK(subject("mine.pipeline", both) == "reflective_shadow_maps");
  CHECK(subject("direct_lighting.pipeline", both) == "direct_lighting");
  CHECK(subject("direct_lighting_and_more.pipeline", both) == "direct_lighting");
  CHECK(subject("mine.pipeline", "  output direct direct.radiance") == "direct_lighting");
  CHECK(subject("mine.pipeline", "") == "reflective_shadow_maps");  // its last pass
  for (const char* file : {"voxelizers/points", "voxelizers/reproject", "voxelizers/solid"})
    CHECK(techniqueOf(pipeline(file), techniques()) == "voxelization");
  CHECK(techniqueOf(pipeline("light_propagation_volumes_voxels"), techniques()) ==
        "light_propagation_volumes");
  CHECK(techniqueOf(pipeline("volumetric_smoke"), techniques()) == "volumetric_smoke");
}

TEST_CASE("a card's list below its heading explains cases, by patterns and for single pipelines") {
  const std::vector<CardRow> rows = whereItBreaks(
      "# A card\n\n- `other`: x. *Why:* y.\n\n## Where it breaks\n\nText.\n\n"
      "- `thin_wall`, `points/*_lowest`: it\n  leaks. *Why:* no\n  sides.\n"
      "- `moved_*`: shifts: much. *Why:* grid\n\n## Limits\n\n- `thin_wall`: no. *Why:* no.\n");
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].what == "it leaks");
  CHECK(rows[0].why == "no sides");
  CHECK(rowFor(rows, "anything", "thin_wall") == rows.data());
  CHECK(rowFor(rows, "anything", "thin_walls") == nullptr);
  CHECK(rowFor(rows, "points", "resolution_lowest") == rows.data());
  CHECK(rowFor(rows, "slicing", "resolution_lowest") == nullptr);
  CHECK(rowFor(rows, "anything", "moved_far") == rows.data() + 1);
  // A row about one pipeline goes before one about all, wherever it is.
  const std::vector<CardRow> both{{{"thin_wall"}, "all", ""}, {{"points/thin_*"}, "one", ""}};
  CHECK(rowFor(both, "points", "thin_wall")->what == "one");
  CHECK(rowFor(both, "slicing", "thin_wall")->what == "all");
  CHECK(rows[1].what == "shifts: much");
  CHECK(whereItBreaks("## Where it breaks\n\nNowhere.\n").empty());
  // The cards of chapters, one behind the other.
  CHECK(whereItBreaks("# whole\n\n## Where it breaks\n\n- `a`: x. *Why:* y.\n# part\n\n- no case\n\n"
                      "## Where it breaks\n\n- `b`: x. *Why:* y.\n")
            .size() == 2);
  CHECK(whereItBreaks("").empty());
}

TEST_CASE("numbers in bold are what cells measure, with their spread") {
  // Within a twentieth, or within one in the last digit where that is more; three standard uncertainties of
  // its own.
  const auto [text, value, uncertainty, admits] = GENERATE(table<const char*, double, double, bool>({
      {"**0.35** of the light", 0.366, 0.0, true},
      {"**0.35** of the light", 0.37, 0.0, false},
      {"**0.35** of the light", 0.8, 0.0, false},
      {"**0.35** of the light", 0.33, 0.0, false},
      {"**0.35** of the light", 0.39, 0.01, true},
      {"**0.35** of the light", 0.40, 0.01, false},
      {"**0.31..0.41** turned", 0.31, 0.0, true},
      {"**0.31..0.41** turned", 0.414, 0.0, true},
      {"**0.31..0.41** turned", 0.42, 0.0, false},
      {"**0.31..0.41** turned", 0.30, 0.0, false},
      {"**0.22 ± 0.03** there", 0.249, 0.0, true},
      {"**0.22 ± 0.03** there", 0.26, 0.0, false},
      {"**1.7e5** as printed", 1.75e5, 0.0, true},
      {"**1.7e5** as printed", 2e5, 0.0, false},
      {"**0.02**", 0.029, 0.0, true},
      {"**0.02**", 0.031, 0.0, false},
      {"**3e2**", 399.0, 0.0, true},
      {"**3.0e2**", 320.0, 0.0, false},
  }));
  CAPTURE(text, value);
  const std::vector<CardNumber> numbers = boldNumbers(text);
  REQUIRE(numbers.size() == 1);
  CHECK(numbers[0].admits({value, uncertainty}) == admits);
  CHECK(boldNumbers("0.35 of the light, *0.2* at 16, **bold**, **0.5..0.4**").empty());
  CHECK(boldNumbers("**0.35** of the light, **0.31..0.41** turned").size() == 2);
}

TEST_CASE("a row of a card explains a cell only when it names the number that the cell measures") {
  const std::vector<CardRow> rows = whereItBreaks(
      "## Where it breaks\n\n"
      "- `thin_wall`: the dark room has **0.35** of the light. *Why:* no sides.\n"
      "- `turned_*`: indirect light changes by **0.11** (quarter turn), **0.31** (others). *Why:* axes.\n"
      "- `far_speck`: much is lost. *Why:* coarse.\n");
  REQUIRE(rows.size() == 3);
  StressCell cell;
  cell.outcome = StressOutcome::biased;
  cell.measure = "mean radiance";
  const auto answer = [&](std::size_t row, double value) {
    cell.value = {value, 0.0};
    return answerOf(rows[row], cell);
  };
  CHECK(answer(0, 0.35).explanation == "the dark room has **0.35** of the light: no sides");
  CHECK(answer(0, 0.35).contradiction.empty());
  // Worse, and better too: what a card says must be so.
  for (const double value : {0.8, 0.1}) {
    CHECK(answer(0, value).explanation.empty());
    CHECK(answer(0, value).contradiction.find("names: 0.35") != std::string::npos);
  }
  // A pattern stands for several cells, each with a number of its own.
  CHECK_FALSE(answer(1, 0.11).explanation.empty());
  CHECK_FALSE(answer(1, 0.31).explanation.empty());
  CHECK(answer(1, 0.2).explanation.empty());
  CHECK(answer(2, 0.2).contradiction.find("names no measured number in bold") != std::string::npos);
  // Where only health was looked at there is nothing to compare.
  cell.measure.clear();
  CHECK_FALSE(answer(2, 0.2).explanation.empty());
}

TEST_CASE("every row of every card names its cases, a measured number and the reason") {
  std::size_t count = 0;
  for (const auto& folder : std::filesystem::directory_iterator(sourceDirectory() / "techniques")) {
    const auto card = folder.path() / "README.md";
    if (!std::filesystem::exists(card)) continue;
    for (const CardRow& row : whereItBreaks(readFile(card))) {
      INFO(card << ": " << row.what);
      CHECK_FALSE(row.cases.empty());
      CHECK_FALSE(row.numbers.empty());
      CHECK_FALSE(row.why.empty());
      ++count;
    }
  }
  CHECK(count > 50);
}

TEST_CASE("a worker that is lost is one broken cell, and so is one that does not start in its place") {
  FalseWorkers workers("if [ $START -eq 2 ]; then echo 'no device' >&2; exit 3; fi",
                       "if [ $START -eq 1 ]; then exit 4; fi; answer");
  workers.options.workers = 1;
  const std::vector<StressCell> cells = workers.run();
  REQUIRE(cells.size() > 3);
  CHECK(brokenOf(cells) == 2);
  CHECK_THAT(cells[0].detail, Tells("its process ended with exit code 4"));
  CHECK(cells[0].device == "a device");
  CHECK_THAT(cells[1].detail, Tells("exit code 3: no device"));
  CHECK(cells[2].detail == "answered");
}

TEST_CASE("a worker that answers nonsense is one broken cell") {
  FalseWorkers workers("", "if [ $START -eq 1 ]; then echo nonsense; else answer; fi");
  workers.options.workers = 1;
  const std::vector<StressCell> cells = workers.run();
  CHECK(brokenOf(cells) == 1);
  CHECK_THAT(cells[0].detail, Tells("did not answer with a cell"));
}

TEST_CASE("when workers no longer start, what was not run says so and takes no stored cell's place") {
  FalseWorkers workers("if [ $START -gt 1 ]; then exit 3; fi", "exit 4");
  workers.options.workers = 1;
  const std::vector<StressCell> cells = workers.run();
  REQUIRE(cells.size() > 4);  // one is lost, three do not start, and the rest is not run
  CHECK(brokenOf(cells) == static_cast<std::ptrdiff_t>(cells.size()));
  CHECK(workers.starts().size() == 4);
  CHECK_THAT(cells.back().detail, Tells("not run: the last 3 workers did not start"));
  CHECK(workers.stored().size() == 4);
}

TEST_CASE("without a single worker there is no battery") {
  FalseWorkers workers("echo 'no device at all' >&2; exit 3", "answer");
  CHECK_THROWS_MATCHES(workers.run(), Error, Tells("no device at all"));
}

TEST_CASE("one graphics device bears one worker, and several share the memory") {
  FalseWorkers device("", "answer", false);
  device.run();
  // Where there are several processors, the first worker has told that there is one device, and gives way.
  const std::vector<std::string> alone = device.starts();
  REQUIRE(alone.size() <= 2);
  CHECK(alone.back().empty());

  for (const bool software : {true, false}) {
    FalseWorkers several("", "answer", software);
    several.options.workers = 3;
    several.options.memoryBytes = 9000;
    several.run();
    const std::vector<std::string> starts = several.starts();
    REQUIRE_FALSE(starts.empty());
    CHECK(starts.size() <= 3);
    for (const std::string& words : starts) CHECK(words == "--worker-memory 3000");
  }
  FalseWorkers one("", "answer");
  one.options.workers = 1;
  one.options.memoryBytes = 9000;
  one.run();
  CHECK(one.starts() == std::vector<std::string>{""});
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
  const auto find = [](const Pipeline& in, const std::string& name) {
    const std::vector<PassParameter> free = freePassParameters(in, techniques());
    const auto found =
        std::find_if(free.begin(), free.end(), [&](const PassParameter& one) { return one.name == name; });
    return found == free.end() ? std::nullopt : std::optional(*found);
  };
  REQUIRE(find(text, "shadow.size"));
  CHECK(find(text, "shadow.size")->value == "64");
  CHECK(find(text, "shadow.size")->low == 16);
  CHECK_FALSE(find(text, "gather.samples"));  // a parameter of the pipeline stands for it

  ParameterValues values, unknown;
  values["shadow.size"].number = 32;
  values["lights.area_samples"].number = 3;
  const Pipeline set = withPassParameters(text, values);
  CHECK(find(set, "shadow.size").value().value == "32");
  CHECK(find(set, "lights.area_samples").value().value == "3");
  CHECK_NOTHROW(checkPipeline(set, techniques()));
  unknown["absent.size"].number = 1;
  CHECK_THROWS_MATCHES(withPassParameters(text, unknown), Error, Tells("absent.size"));
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
  CHECK_THROWS_MATCHES(requestOf("{}"), Error, Tells("no request"));
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
  CHECK_THAT(shell.ending(), Tells("killed by signal 9"));
  CHECK(shell.lastWords() == "lost");
  shell.send("nobody hears");  // and nobody is killed by it

  // A grandchild that holds the pipe open, and would for a minute.
  const auto start = std::chrono::steady_clock::now();
  { Child nested({"/bin/sh", "-c", "sleep 60 & sleep 60"}, {}); }
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
  CHECK_THROWS_MATCHES(Child({"/no/such/program"}, {}), Error, Tells("/no/such/program"));
}
