// Scenes and pipelines by their names, wherever a command takes a text.
#include <algorithm>

#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("a name that list prints stands for its text") {
  CHECK(contains(runCommand("lumivox check cornell voxel_cone_tracing").output, "cornell.scene: good"));
  const CommandResult byName = runCommand("lumivox shaders cornell direct_lighting"),
                      byPath = runCommand("lumivox shaders '" +
                                          (sourceDirectory() / "scenes/cornell.scene").string() + "' '" +
                                          committedPipeline("direct_lighting") + "'");
  INFO(byName.errors);
  CHECK(byName.exitCode == 0);
  CHECK_FALSE(byName.output.empty());
  CHECK(byName.output == byPath.output);
}

TEST_CASE("a name that is none is refused with the nearest, and one of the other kind with what it is") {
  checkRefused(runCommand("lumivox shaders cornell direct_lightin"), "did you mean 'direct_lighting'");
  checkRefused(runCommand("lumivox shaders direct_lighting cornell"), "'direct_lighting' is a pipeline");
}

TEST_CASE("the program's name alone is answered with the first three things to type, short") {
  const CommandResult result = runCommand("lumivox");
  checkRefused(result, "lumivox list scenes");
  CHECK(contains(result.errors, "lumivox render cornell voxel_cone_tracing -o out.png"));
  CHECK(contains(result.errors, "lumivox report cornell --budget 60s"));
  CHECK(contains(result.errors, "lumivox help"));
  CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') <= 6);
}

TEST_CASE("describe finds a word by its singular or plural") {
  const CommandResult one = runCommand("lumivox describe cone"), many = runCommand("lumivox describe cones");
  CHECK(one.exitCode == 0);
  CHECK(contains(one.output, "parameter cones of voxel_cone_tracing.gather"));
  CHECK(one.output == many.output);
}
