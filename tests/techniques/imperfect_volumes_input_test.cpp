// What a pipeline of imperfect volumes can have wrong, as a user would: files through the command.
#include <string>

#include "support/imperfect_volumes_scene.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;
using Catch::Matchers::Contains;

namespace {

/// The committed pipeline with a piece of its text replaced.
std::string changed(const std::string& name, const std::string& old, const std::string& by) {
  std::string text = pipeline(name).document->source;
  const std::size_t at = text.find(old);
  REQUIRE(at != std::string::npos);
  return text.replace(at, old.size(), by);
}

/// What the command says when it is given such a pipeline on the Cornell box; it must refuse it.
std::string refusal(const std::string& text, const std::string& options = "") {
  const TemporaryDirectory place;
  const CommandResult result =
      runCommand("lumivox render '" + (sourceDirectory() / "scenes/cornell.scene").string() + "' '" +
                 place.write("wrong.pipeline", text).string() + "' -q --resolution 8x8 -o '" +
                 (place.path() / "image.exr").string() + "' " + options);
  INFO(result.errors);
  CHECK(result.exitCode == 2);
  CHECK_FALSE(std::filesystem::exists(place.path() / "image.exr"));
  return result.errors;
}

}  // namespace

TEST_CASE("volumes of two placements in one pipeline are refused with both") {
  const std::string second =
      "  pass coarse voxelization.points {\n    resolution 16\n    adaptive on\n  }\n"
      "  pass inject imperfect_volumes.inject {\n    fragments coarse.fragments\n";
  const std::string told =
      refusal(changed("imperfect_volumes",
                      "  pass inject imperfect_volumes.inject {\n    fragments voxels.fragments\n", second));
  CHECK_THAT(told, Contains("pass march") && Contains("'reflected' has 16 x") && Contains("'opacity' 32 x") &&
                       Contains("expected one grid for both"));
}

TEST_CASE("flux of propagation volumes in place of radiance is refused by name") {
  const std::string flux =
      "  pass inject light_propagation_volumes.inject_voxels {\n    fragments voxels.fragments\n"
      "    shadow shadow.depth\n    levels 1\n  }\n";
  std::string text = changed("imperfect_volumes",
                             "  pass inject imperfect_volumes.inject {\n    fragments voxels.fragments\n"
                             "    shadow shadow.depth\n  }\n",
                             flux);
  const std::string reads = "inject.reflected";
  text.replace(text.find(reads), reads.size(), "inject.light");
  CHECK_THAT(refusal(text), Contains("pass march") && Contains("'reflected' contains flux") &&
                                Contains("expected the radiance in each voxel"));
}

TEST_CASE("a guard that is longer than any ray through the volume is refused with both lengths") {
  const std::string told =
      refusal(changed("imperfect_volumes", "    bounces $bounces\n", "    bounces $bounces\n    guard 56\n"));
  CHECK_THAT(told, Contains("pass march") && Contains("'guard' is 56 voxels") && Contains("expected less"));
}

TEST_CASE("more bounces than the pass takes are refused with the range, and the pipeline has its own") {
  const std::string told = refusal(changed("imperfect_volumes", "bounces $bounces", "bounces 1025"));
  CHECK_THAT(told, Contains("bounces") && Contains("1..1024") && Contains("wrong.pipeline"));
  CHECK_THAT(refusal(pipeline("imperfect_volumes").document->source, "--set bounces=65"),
             Contains("bounces") && Contains("1..64"));
}

TEST_CASE("a volume that does not fit is refused with its bytes and the largest that fits") {
  // 128^3 voxels of three volumes of 16 bytes each: 96 MiB.
  const std::string told = refusal(pipeline("imperfect_volumes").document->source,
                                   "--set resolution=128 --set density=0.1 --memory 80MiB");
  CHECK_THAT(told, Contains("three volumes of coefficients of 128 voxels along the longest side takes") &&
                       Contains("the largest that fits is"));
}
