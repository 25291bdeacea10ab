// What figures of the thesis (Gomes 2015) must show, as numbers, from the texts that reproduce them
// (scenes/reproductions) on scenes that are in the tree.
#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSize = 48;  // pixels along both sides

std::map<std::string, ImageBuffer> outputsOf(const char* scene, const std::filesystem::path& file,
                                             const std::vector<std::string>& settings) {
  const Pipeline text = Pipeline::load(sourceDirectory() / file);
  RenderOptions options;
  options.width = options.height = kSize;
  options.parameters = text.settings(settings);
  return renderOnce(loadScene(sourceDirectory() / "scenes" / (std::string(scene) + ".scene")), text, options)
      .outputs;
}

double mean(const ImageBuffer& image, int channel = -1) {
  double sum = 0.0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (int c = 0; c < 3; ++c)
        if (channel < 0 || c == channel) sum += image.at(x, y, c);
  return sum;
}

}  // namespace

TEST_CASE(
    "Fig. 61: direct, indirect diffuse and indirect specular light as printed add up to the final image") {
  const auto outputs =
      outputsOf("cornell_glossy", "scenes/reproductions/004_table_3.pipeline", {"resolution=32"});
  const double parts =
      mean(outputs.at("direct")) + mean(outputs.at("indirect_diffuse")) + mean(outputs.at("indirect_glossy"));
  CHECK(mean(outputs.at("indirect_diffuse")) > 0.0);
  CHECK(mean(outputs.at("indirect_glossy")) > 0.0);
  CHECK(mean(outputs.at("final")) == Approx(parts).epsilon(1e-4));
}

TEST_CASE("Fig. 64: voxels composited along x keep what looks to either side apart, at every level") {
  for (const char* level : {"level=0", "level=2"}) {
    CAPTURE(level);
    const auto outputs = outputsOf("cornell", "docs/examples/see_stores.pipeline", {"resolution=32", level});
    // The green wall looks to higher x, the red one to lower x; one grid has both.
    const ImageBuffer &higher = outputs.at("positive_x"), &lower = outputs.at("negative_x"),
                      &both = outputs.at("one_grid");
    CHECK(mean(higher, 1) > 1.5 * mean(higher, 0));
    CHECK(mean(lower, 0) > 2.0 * mean(lower, 1));
    CHECK(mean(both, 0) > mean(higher, 0));
    CHECK(mean(both, 1) > mean(lower, 1));
  }
}

TEST_CASE("Fig. 66: ambient light at injection shows in reflections what no light reaches") {
  const auto dark = outputsOf("cornell_glossy", "scenes/reproductions/004_cone_steps.pipeline",
                              {"resolution=32"}),
             lit = outputsOf("cornell_glossy", "scenes/reproductions/004_cone_steps.pipeline",
                             {"resolution=32", "ambient=1"});
  const ImageBuffer &without = dark.at("indirect_glossy"), &with = lit.at("indirect_glossy");
  CHECK(mean(with) > 1.5 * mean(without));
  int appeared = 0;  // pixels whose reflection was a tenth of what it is now
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      appeared += with.at(x, y, 1) > 0.001f && without.at(x, y, 1) < 0.1f * with.at(x, y, 1);
  CHECK(appeared > 10);
}
