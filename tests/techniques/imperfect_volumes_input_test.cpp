// What a pipeline of imperfect volumes can have wrong, as a user would: files through the command.
#include <optional>
#include <string>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/imperfect_volumes_scene.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

/// The committed pipeline with a piece of its text replaced.
std::string changed(const std::string& name, const std::string& old, const std::string& by) {
  std::string text = pipeline(name).document->source;
  const std::size_t at = text.find(old);
  REQUIRE(at != std::string::npos);
  return text.replace(at, old.size(), by);
}

/// Why such a pipeline cannot light the Cornell box.
std::string refusal(const std::string& text, const std::vector<std::string>& settings = {},
                    std::uint64_t memoryBytes = 0) {
  std::optional<gpu::Device> tight;
  if (memoryBytes > 0) tight.emplace(gpu::DeviceOptions{.memoryBytes = memoryBytes});
  return messageOf<Error>([&] {
    const Pipeline wrong = Pipeline::parse(text, "wrong.pipeline");
    RenderOptions options = sized(8, 8);
    options.parameters = wrong.settings(settings);
    const Scene scene = committed("cornell");
    PipelineExecutor(tight ? *tight : device(), techniques(), scene, wrong, options).render(0.0);
  });
}
/// Of a committed pipeline with a piece of its text replaced.
std::string refusalOf(const std::string& old, const std::string& by) {
  return refusal(changed("imperfect_volumes", old, by));
}

}  // namespace

TEST_CASE(
    "volumes of two placements, flux in place of radiance and other voxels than were made are refused") {
  const std::string inject = "  pass inject imperfect_volumes.inject {\n    fragments voxels.fragments\n";
  CHECK_THAT(refusalOf(inject,
                       "  pass coarse voxelization.points {\n    resolution 16\n    adaptive on\n  }\n"
                       "  pass inject imperfect_volumes.inject {\n    fragments coarse.fragments\n"),
             Tells("march", "reflected", "16 x", "opacity", "32 x"));
  std::string text = changed("imperfect_volumes", inject + "    shadow shadow.depth\n    lobes $lobes\n  }\n",
                             "  pass inject light_propagation_volumes.inject_voxels {\n"
                             "    fragments voxels.fragments\n    shadow shadow.depth\n    levels 1\n  }\n");
  const std::string reads = "inject.reflected";
  text.replace(text.find(reads), reads.size(), "inject.light");
  CHECK_THAT(refusal(text), Tells("march", "reflected", "flux", "radiance", "W/(sr m^2)"));
  CHECK_THAT(refusalOf("    incoming march.incoming\n", "    incoming march.incoming\n    voxels eight\n"),
             Tells("gather", "voxels six", "voxels eight", "cover all"));
}

TEST_CASE("lengths, bounces and volumes that are too large are refused with what would do") {
  const std::string bounces = "    bounces $bounces\n";
  CHECK_THAT(refusalOf(bounces, bounces + "    guard 56\n"), Tells("march", "guard", 56));
  CHECK_THAT(refusalOf("bounces $bounces", "bounces 1025"), Tells("wrong.pipeline", "bounces", "1..1024"));
  CHECK_THAT(refusal(pipeline("imperfect_volumes").document->source, {"bounces=65"}),
             Tells("bounces", "1..64"));
  // 128^3 voxels of three volumes of 16 bytes each: 96 MiB.
  CHECK_THAT(
      refusal(pipeline("imperfect_volumes").document->source, {"resolution=128", "density=0.1"}, 80u << 20),
      Tells("coefficients", 128));
  CHECK_THAT(refusal(changed("imperfect_volumes", "resolution 32 in 1..512", "resolution 32 in 1..1024"),
                     {"resolution=1024", "density=0.01"}, 1u << 30),
             Tells(1024, "GiB"));
  // By the technique itself, whatever a voxelizer has room for.
  const Volume small({2, 2, 2});
  OccupancyGrid opacity = small.opacity();
  opacity.grid.resolution = glm::ivec3(1024);
  LonePass march = volumePass("march", underSky(1.0)), occlude = volumePass("occlude", underSky(1.0));
  march.in("reflected", small.reflected()).in("attributes", small.attributes());
  for (LonePass* pass : {&march, &occlude})
    CHECK_THROWS_MATCHES(pass->in("opacity", opacity).run(), Error,
                         Tells("1024 x 1024 x 1024", "16.0", "2^29"));
}

TEST_CASE("what a choice of words reads must be connected, and is told by name") {
  const std::string bounces = "    bounces $bounces\n", incoming = "    incoming march.incoming\n",
                    opacity = "    opacity average.opacity\n",
                    attributes = "    attributes average.attributes\n";
  CHECK_THAT(refusalOf(bounces, bounces + "    walk exact\n"), Tells("march", "walk exact", "bits"));
  CHECK_THAT(refusalOf(incoming + opacity, incoming), Tells("gather", "blend free", "opacity"));
  CHECK_THAT(refusalOf(opacity + attributes + "  }\n  pass compose", opacity + "  }\n  pass compose"),
             Tells("gather", "blend free", "attributes"));
  CHECK_THAT(refusalOf(incoming, ""), Tells("gather", "diffuse", "incoming"));
  CHECK_THAT(refusalOf(attributes + "    gbuffer gbuffer\n", "    gbuffer gbuffer\n"),
             Tells("march", "source surface", "attributes"));
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
  CHECK_THAT(result.errors, Catch::Contains(said));
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
