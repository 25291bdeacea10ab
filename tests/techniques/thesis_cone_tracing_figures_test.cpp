// What a figure of the thesis (Gomes 2015) must show, as numbers, from the text that reproduces it
// (scenes/reproductions) on a scene that is in the tree.
#include "support/against_reference.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSize = 48;  // pixels along both sides

}  // namespace

TEST_CASE(
    "Fig. 61: each part as printed lies where the path tracer has it, reflections with a fifth of their light") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell_glossy.scene");
  const Pipeline text = Pipeline::load(sourceDirectory() / "scenes/reproductions/004_table_3.pipeline");
  RenderOptions options;
  options.width = options.height = kSize;
  options.parameters = text.settings({"resolution=32"});
  const auto outputs = renderOnce(scene, text, options).outputs;
  const LayeredImage reference = referenceOf(scene, {kSize, kSize, 256});
  // Each part is the path tracer's light of its name, in the pixels that have it: the glossy part lies on the
  // floor and on the tall box, and nowhere else.
  const ImageBuffer &glossy = outputs.at("indirect_glossy"),
                    &trueGlossy = reference.layers.at("one_bounce_glossy");
  int elsewhere = 0, there = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      there += glossy.at(x, y, 0) > 0.0f && trueGlossy.at(x, y, 0) > 0.0f;
      elsewhere += glossy.at(x, y, 0) > 0.0f && !(trueGlossy.at(x, y, 0) > 0.0f);
    }
  CAPTURE(there, elsewhere);
  CHECK(there > kSize * kSize / 10);
  CHECK(elsewhere < there / 20);
  // By the render of the same scene and size: diffuse 1.23 of the light, glossy 0.22, direct light 1.12 with
  // one sample a pixel at silhouettes.
  CHECK(against(reference, outputs.at("direct"), "direct", 0.0f).ratio == Approx(1.12).margin(0.1));
  CHECK(against(reference, outputs.at("indirect_diffuse"), "one_bounce_diffuse", 0.0f).ratio ==
        Approx(1.23).margin(0.15));
  CHECK(against(reference, glossy, "one_bounce_glossy", 0.0f).ratio == Approx(0.215).margin(0.06));
  const auto total = [&](const char* output) {
    double sum = 0.0;
    for (int i = 0; i < 3 * kSize * kSize; ++i)
      sum += outputs.at(output).at(i / 3 % kSize, i / 3 / kSize, i % 3);
    return sum;
  };
  CHECK(total("final") ==
        Approx(total("direct") + total("indirect_diffuse") + total("indirect_glossy")).epsilon(1e-4));
}
