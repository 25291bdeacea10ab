// Promises of the scenes about their images, checked with the path tracer.
#include "lumivox/reference/path_tracer.h"
#include "lumivox/scene/scene.h"
#include "support/support.h"

using namespace lumivox;

namespace {

LayeredImage reference(const std::string& scene, int size, int samples) {
  ReferenceOptions options;
  options.width = options.height = size;
  options.samplesPerPixel = samples;
  options.progress = false;
  options.useCache = false;
  return renderReference(loadScene(test::sourceDirectory() / "scenes" / (scene + ".scene")), options);
}

double mean(const ImageBuffer& image, int channel) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) sum += image.at(x, y, channel);
  return sum / static_cast<double>(image.pixelCount());
}

}  // namespace

TEST_CASE("the corridor's camera sees light, and none of it directly") {
  const LayeredImage image = reference("corridor", 32, 16);
  const ImageBuffer& direct = image.layers.at("direct");
  for (const float value : direct.values()) REQUIRE(value == 0.0f);
  CHECK(mean(image.layers.at("indirect_diffuse"), 0) > 0.01);
}

TEST_CASE("the furnace glows at 1 / (1 - albedo) everywhere") {
  const LayeredImage image = reference("furnace", 16, 64);
  const ImageBuffer& full = image.layers.at("full");
  // Emission 1, albedo 0.5: 1 + 0.5 + 0.25 + ... = 2. The noise of 64 samples in 256 pixels is far below one
  // per cent.
  for (int channel = 0; channel < 3; ++channel) CHECK(mean(full, channel) == Approx(2.0).epsilon(0.01));
}

TEST_CASE("a room without light is exactly black") {
  for (const auto& [name, layer] : reference("stress/no_light", 16, 4).layers) {
    if (name.rfind("ambient_occlusion", 0) == 0) continue;  // needs no light
    INFO(name);
    for (const float value : layer.values()) REQUIRE(value == 0.0f);
  }
}

TEST_CASE("without triangles the camera sees the environment and nothing else") {
  const ImageBuffer full = reference("stress/no_triangles", 8, 4).layers.at("full");
  for (int y = 0; y < full.height(); ++y)
    for (int x = 0; x < full.width(); ++x) {
      CHECK(full.at(x, y, 0) == Approx(0.25));
      CHECK(full.at(x, y, 1) == Approx(0.5));
      CHECK(full.at(x, y, 2) == Approx(1.0));
    }
}

TEST_CASE("the red wall of the Cornell box is on the left of its image and the green one on the right") {
  const ImageBuffer full = reference("cornell", 32, 64).layers.at("full");
  double left[3] = {}, right[3] = {};
  for (int y = 8; y < 24; ++y)
    for (int c = 0; c < 3; ++c) {
      left[c] += full.at(3, y, c);
      right[c] += full.at(28, y, c);
    }
  CHECK(left[0] > 3 * left[1]);
  // The area light is reddish (17 to 12): direct light alone leaves 0.45 * 12 / (0.14 * 17) = 2.3 on the
  // green wall.
  CHECK(right[1] > 1.5 * right[0]);
  CHECK(right[1] > right[2]);
}

TEST_CASE("the Cornell box's image does not depend on where it stands or how large it is") {
  const ImageBuffer here = reference("cornell", 16, 256).layers.at("full");
  for (const char* name : {"stress/far_away", "stress/tiny", "stress/huge"}) {
    INFO(name);
    const ImageBuffer there = reference(name, 16, 256).layers.at("full");
    for (int channel = 0; channel < 3; ++channel)
      CHECK(mean(there, channel) == Approx(mean(here, channel)).epsilon(0.02));
  }
}
