// What a pipeline of imperfect volumes can have wrong, as a user would: files through the command.
#include <set>
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
                                Contains("expected radiance in W/(sr m^2)"));
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

TEST_CASE("a volume of 1024 voxels along a side is refused with its bytes") {
  const std::string text =
      changed("imperfect_volumes", "resolution 32 in 1..512", "resolution 32 in 1..1024");
  CHECK_THAT(refusal(text, "--set resolution=1024 --set density=0.01 --memory 1GiB"),
             Contains("1024") && Contains("GiB"));
  // By the technique itself, whatever a voxelizer has room for.
  const Volume small({2, 2, 2});
  OccupancyGrid opacity = small.opacity();
  opacity.grid.resolution = glm::ivec3(1024);
  for (const char* pass : {"march", "occlude"}) {
    Runner runner(pass, underSky(1.0));
    runner.in("opacity", opacity);
    if (std::string(pass) == "march")
      runner.in("reflected", small.reflected()).in("attributes", small.attributes());
    CHECK_THROWS_WITH(runner.run<ShGrid>(std::string(pass) == "march" ? "incoming" : "visibility"),
                      Contains("1024 x 1024 x 1024 voxels take 16") && Contains("at most 2^29 voxels"));
  }
}

TEST_CASE("what a choice of words reads must be connected, and is told by name") {
  CHECK_THAT(refusal(changed("imperfect_volumes", "    bounces $bounces\n",
                             "    bounces $bounces\n    walk exact\n")),
             Contains("pass march") && Contains("'walk exact' goes through 'bits'"));
  CHECK_THAT(
      refusal(changed("imperfect_volumes", "    incoming march.incoming\n    opacity average.opacity\n",
                      "    incoming march.incoming\n")),
      Contains("pass gather") && Contains("'blend free' reads 'opacity'"));
  CHECK_THAT(
      refusal(changed("imperfect_volumes",
                      "    opacity average.opacity\n    attributes average.attributes\n  }\n  pass compose",
                      "    opacity average.opacity\n  }\n  pass compose")),
      Contains("pass gather") && Contains("'blend free' reads 'attributes'"));
  CHECK_THAT(refusal(changed("imperfect_volumes", "    incoming march.incoming\n", "")),
             Contains("pass gather") && Contains("'diffuse' is made of 'incoming'"));
  CHECK_THAT(refusal(changed("imperfect_volumes", "    attributes average.attributes\n    gbuffer gbuffer\n",
                             "    gbuffer gbuffer\n")),
             Contains("pass march") && Contains("'source surface' and further bounces read 'attributes'"));
}

TEST_CASE("surfaces must read as the voxels were made for them, or the refusal tells both ways") {
  const std::string told = refusal(changed("imperfect_volumes", "    incoming march.incoming\n",
                                           "    incoming march.incoming\n    voxels eight\n"));
  CHECK_THAT(told, Contains("pass gather") && Contains("'voxels six'") && Contains("'voxels eight'") &&
                       Contains("'cover all'"));
}

TEST_CASE("in a scene with a medium the light is gathered without it, and the command says so once") {
  const TemporaryDirectory place;
  const CommandResult result =
      runCommand("lumivox render '" + (sourceDirectory() / "scenes/smoke.scene").string() + "' '" +
                 (sourceDirectory() / "scenes/pipelines/imperfect_volumes.pipeline").string() +
                 "' --resolution 8x8 --set resolution=8 --set rays=4 --output indirect_diffuse -o '" +
                 (place.path() / "image.exr").string() + "'");
  INFO(result.errors);
  CHECK(result.exitCode == 0);
  const std::string said = "leaves out medium 'smoke': no pass reads media";
  CHECK_THAT(result.errors, Contains(said));
  std::size_t times = 0;
  for (std::size_t at = result.errors.find("medi"); at != std::string::npos;
       at = result.errors.find("medi", at + 1))
    ++times;
  CHECK(times == 2);  // "medium", "media": in that sentence alone
}

TEST_CASE("only the passes that an output needs run, with the same bits") {
  const Scene scene = committed("cornell");
  const Pipeline text = pipeline("imperfect_volumes_occlusion");
  RenderOptions options;
  options.width = options.height = 16;
  options.parameters = text.settings({"resolution=16", "rays=16"});
  const auto passesOf = [](const FrameResult& frame) {
    std::set<std::string> names;
    for (const PassRecord& pass : frame.passes) names.insert(pass.name);
    return names;
  };
  const FrameResult both = renderOnce(scene, text, options);
  options.wanted = {"ambient_occlusion"};
  const FrameResult open = renderOnce(scene, text, options);
  for (const char* light : {"inject", "march", "shadow", "direct"}) {
    CHECK_FALSE(passesOf(open).contains(light));
    CHECK(passesOf(both).contains(light));
  }
  CHECK(passesOf(open).contains("occlude"));
  CHECK(open.outputs.at("ambient_occlusion").values() == both.outputs.at("ambient_occlusion").values());
  CHECK(open.peakBytes < both.peakBytes);
  options.wanted = {"indirect_diffuse"};
  const FrameResult light = renderOnce(scene, text, options);
  CHECK_FALSE(passesOf(light).contains("occlude"));
  CHECK(light.outputs.at("indirect_diffuse").values() == both.outputs.at("indirect_diffuse").values());
  // A dark world has no light to gather.
  Scene dark = scene;
  dark.lights.clear();
  dark.environment = glm::vec3(0.0f);
  for (Material& material : dark.materials) material.emission = glm::vec3(0.0f);
  options.wanted = {};
  const FrameResult nothing = renderOnce(dark, text, options);
  for (const char* pass : {"inject", "march"}) CHECK_FALSE(passesOf(nothing).contains(pass));
  CHECK(passesOf(nothing).contains("occlude"));
  for (const float value : nothing.outputs.at("indirect_diffuse").values()) CHECK(value == 0.0f);
}

TEST_CASE("further bounces have their volumes, and one bounce of two bands has no attributes") {
  const Scene scene = committed("cornell");
  const auto peak = [&](const std::string& text, const std::vector<std::string>& settings) {
    const Pipeline parsed = Pipeline::parse(text, pipeline("imperfect_volumes").file);
    RenderOptions options;
    options.width = options.height = 8;
    options.wanted = {"indirect_diffuse"};
    options.parameters = parsed.settings(settings);
    return renderOnce(scene, parsed, options);
  };
  const std::string text = pipeline("imperfect_volumes").document->source;
  const std::vector<std::string> small{"resolution=64", "rays=2", "density=0.1"};
  std::vector<std::string> twice = small;
  twice.push_back("bounces=2");
  // Three volumes of 16 bytes a voxel each, which are passed on and which arrive again.
  constexpr std::uint64_t kVolumes = 3ull * 16 * 64 * 64 * 64;
  const std::uint64_t one = peak(text, small).peakBytes, two = peak(text, twice).peakBytes;
  CAPTURE(one, two);
  CHECK(two >= one + kVolumes);
  CHECK(two <= one + 2 * kVolumes + kVolumes / 2);
  // Nobody reads mean normals and albedos where neighbours count as they are and two bands are evaluated.
  const auto printed = [&](const char* source) {
    std::string other = changed("imperfect_volumes", "    bounces $bounces\n",
                                std::string("    bounces $bounces\n    source ") + source + "\n");
    const std::string reads = "    incoming march.incoming\n";
    return other.replace(other.find(reads), reads.size(), reads + "    blend all\n");
  };
  CHECK(peak(printed("harmonics"), small).peakBytes < peak(printed("surface"), small).peakBytes);
}
