// What figures of the thesis (Gomes 2015) must show, as numbers, from the texts that reproduce them
// (scenes/reproductions) on scenes that are in the tree.
#include <cmath>

#include "support/against_reference.h"

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
    "Figs. 62 and 63: half the step along a cone halves the bands that whole steps make in reflections") {
  const auto reflections = [](const char* step) {
    return outputsOf("cornell_glossy", "scenes/reproductions/004_cone_steps.pipeline",
                     {"resolution=64", step})
        .at("indirect_glossy");
  };
  const ImageBuffer fine = reflections("step=0.05");
  // RMS difference from reflections by steps that are as good as none, over their mean.
  const auto bands = [&](const char* step) {
    const ImageBuffer image = reflections(step);
    double sum = 0.0;
    for (std::size_t i = 0; i < image.values().size(); ++i)
      sum += std::pow(image.values()[i] - fine.values()[i], 2);
    return std::sqrt(sum / static_cast<double>(image.values().size())) / mean(fine) * (3 * kSize * kSize);
  };
  const double whole = bands("step=1"), half = bands("step=0.5"), quarter = bands("step=0.25");
  CAPTURE(whole, half, quarter);
  CHECK(whole > 0.1);
  CHECK(half == Approx(0.5 * whole).epsilon(0.2));
  CHECK(quarter == Approx(0.25 * whole).epsilon(0.2));
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

TEST_CASE(
    "Fig. 87: in the clipmap reflections have nine tenths of their light, and the floor takes the walls' colours") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell_glossy.scene");
  const Pipeline text = pipeline("voxel_cone_tracing_clipmap");
  const auto outputs = pictured(scene, {kSize, kSize}, text, {"resolution=32"}).outputs;
  const LayeredImage reference = referenceOf(scene, {kSize, kSize, 256});
  const ImageBuffer &glossy = outputs.at("indirect_glossy"),
                    &trueGlossy = reference.layers.at("one_bounce_glossy");
  CHECK(against(reference, glossy, "one_bounce_glossy", 0.0f).ratio == Approx(0.93).margin(0.1));
  // Red beside green, in the left and in the right half, where red and green walls are reflected.
  const auto redness = [](const ImageBuffer& image, int from) {
    double red = 0.0, green = 0.0;
    for (int y = kSize / 2; y < kSize; ++y)
      for (int x = from; x < from + kSize / 2; ++x) red += image.at(x, y, 0), green += image.at(x, y, 1);
    return red / green;
  };
  for (const int from : {0, kSize / 2}) {
    CAPTURE(from);
    CHECK(redness(glossy, from) == Approx(redness(trueGlossy, from)).epsilon(0.1));
  }
}
