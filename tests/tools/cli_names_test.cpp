// Scenes and pipelines by their names, wherever a command takes a text.
#include <algorithm>
#include <regex>
#include <sstream>

#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("a name that list prints stands for its text") {
  CHECK(contains(typed("check cornell voxel_cone_tracing").output, "cornell.scene: good"));
  const CommandResult byName = typed("shaders cornell direct_lighting"),
                      byPath = typed("shaders", sourceDirectory() / "scenes/cornell.scene",
                                     committedPipeline("direct_lighting"));
  INFO(byName.errors);
  CHECK(byName.exitCode == 0);
  CHECK_FALSE(byName.output.empty());
  CHECK(byName.output == byPath.output);
}

TEST_CASE("a name that is none is refused with the nearest, and one of the other kind with what it is") {
  checkRefused(typed("shaders cornell direct_lightin"), "did you mean 'direct_lighting'");
  checkRefused(typed("shaders direct_lighting cornell"), "'direct_lighting' is a pipeline");
}

TEST_CASE("a technique that is not found is told with the folders that --techniques names") {
  const TemporaryDirectory work;
  const std::string text = work.write("mine.pipeline",
                                      "pipeline \"mine\" {\n  pass a ambient.gather { }\n"
                                      "  output o a.diffuse\n}\n")
                               .string();
  const CommandResult result = typed("check", text, "--techniques", work.path());
  checkRefused(result, "no libambient.so in " + work.path().string() + ", ");
  CHECK(contains(result.errors, "(--techniques FOLDER adds one)"));
}

TEST_CASE("the program's name alone is answered with the first three things to type, short") {
  const CommandResult result = typed("");
  checkRefused(result, "lumivox help");
  CHECK(contains(result.errors, "lumivox list scenes"));
  CHECK(contains(result.errors, "lumivox render cornell voxel_cone_tracing -o out.png"));
  CHECK(contains(result.errors, "lumivox report cornell --budget 60s"));
  CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') <= 6);
}

TEST_CASE("describe fits the terminal, and names many passes with a port of the name in one paragraph") {
  const CommandResult result =
      runCommand("COLUMNS=80 " + (binaryDirectory() / "bin/lumivox").string() + " describe light");
  REQUIRE(result.exitCode == 0);
  CHECK(result.output.rfind("light [NAME] area|directional|point|spot { ... } (in scene)\n", 0) == 0);
  std::istringstream lines(result.output);
  for (std::string line; std::getline(lines, line);) {
    INFO(line);
    CHECK(line.size() <= 80);
  }
  const std::string text = std::regex_replace(result.output, std::regex("\\s+"), " ");
  CHECK(contains(
      text, "input light of 8 passes: implicit_visibility.display, light_propagation_volumes.propagate, "));
  CHECK(contains(text, "lumivox describe implicit_visibility.display explains one of them"));
  CHECK_FALSE(contains(text, "(SparseLight): averaged light, of gather"));
  // What goes on stands below the column that it belongs to.
  CHECK(std::regex_search(result.output, std::regex("\n  inner      half angle [^\n]*\n             [^ ]")));
  // A name of few ports is explained in full.
  CHECK(contains(typed("describe cones").output, "parameter cones of voxel_cone_tracing.gather (an"));
}

TEST_CASE("describe explains a word once where it means the same at several places, and names them") {
  const std::string text = std::regex_replace(typed("describe camera").output, std::regex("\\s+"), " ");
  INFO(text);
  CHECK(contains(text,
                 "camera (in reproduction, reproduction > row, reproduction > curve, reproduction > curve > "
                 "point, reproduction > panel) camera of the scene; without it the first a name"));
  std::size_t times = 0;
  for (std::size_t at = text.find("without it the first"); at != std::string::npos;
       at = text.find("without it the first", at + 1))
    ++times;
  CHECK(times == 1);
  // What means something else stands apart.
  CHECK(contains(text, "camera NAME { ... } (in scene) "));
  CHECK(contains(text, "camera (in view) looks through a camera of the scene"));
}

TEST_CASE("describe finds a word by its singular or plural") {
  const CommandResult one = typed("describe cone"), many = typed("describe cones");
  CHECK(one.exitCode == 0);
  CHECK(contains(one.output, "parameter cones of voxel_cone_tracing.gather"));
  CHECK(one.output == many.output);
}
