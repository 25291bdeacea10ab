// Which pixels show what shines, on scenes where it is known.
#include <numeric>

#include "lumivox/reference/emission.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

std::size_t countOf(const std::vector<unsigned char>& pixels) {
  return std::accumulate(pixels.begin(), pixels.end(), std::size_t{0});
}

/// A quad of one by one metre in the middle of a view of two by two, turned to the camera or away from it.
SceneBuilder panel(bool towards) {
  SceneBuilder builder;
  const glm::vec3 right{1, 0, 0}, up{0, 1, 0};
  builder.quad({-0.5f, -0.5f, 0}, towards ? right : up, towards ? up : right, builder.lambert(0.5f, 3.0f));
  builder.look({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(1.0), 40, 40);
  return builder;
}

}  // namespace

TEST_CASE("a pixel emits where it or a neighbour shows the shining side of an area light, and nowhere else") {
  const SceneBuilder front = panel(true), back = panel(false);
  const std::vector<unsigned char> pixels = emittingPixels(front.scene, snapshotOf(front.scene, 0.0));
  REQUIRE(pixels.size() == 1600);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      CAPTURE(x, y);
      REQUIRE(int{pixels[static_cast<std::size_t>(40 * y + x)]} == (x >= 9 && x <= 30 && y >= 9 && y <= 30));
    }
  CHECK(countOf(emittingPixels(back.scene, snapshotOf(back.scene, 0.0))) == 0);
}

TEST_CASE("the sky emits where nothing hides it, and a scene where nothing shines has no such pixels") {
  SceneBuilder dark = panel(true);
  for (Material& material : dark.scene.materials) material.emission = glm::vec3(0.0f);
  CHECK(emittingPixels(dark.scene, snapshotOf(dark.scene, 0.0)).empty());
  dark.scene.environment = glm::vec3(0.1f);
  CHECK(countOf(emittingPixels(dark.scene, snapshotOf(dark.scene, 0.0))) == 1200);
}

TEST_CASE("pixels that emit are those in which the reference without any further light is not black") {
  const Scene scene = litRoom(48, 48);
  ReferenceOptions options = quietly(16, 0);
  const LayeredImage reference = renderReference(scene, options);
  const std::vector<unsigned char> pixels = emittingPixels(scene, snapshotOf(scene, 0.0));
  REQUIRE(countOf(pixels) > 5);
  // The lamp of 15 W/(sr m2) is far brighter than what it lights, also in a hundredth of a pixel.
  std::size_t shining = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const bool shines = reference.layers.at("direct").values()[3 * i] > 7.5f;
    shining += shines ? 1 : 0;
    if (shines) CHECK(int{pixels[i]} == 1);
  }
  REQUIRE(shining > 5);
  CHECK(countOf(pixels) < 4 * shining);
}

TEST_CASE("through a lens the pixels that emit are those over which a lamp is spread") {
  Scene scene = litRoom(48, 48);
  scene.cameras.front().aperture = 0.3;
  scene.cameras.front().focus = 0.8;  // in front of the room
  const std::vector<unsigned char> pixels = emittingPixels(scene, snapshotOf(scene, 0.0));
  const LayeredImage reference = renderReference(scene, quietly(256, 0));
  const std::size_t sharp = countOf(emittingPixels(litRoom(48, 48), snapshotOf(litRoom(48, 48), 0.0)));
  CHECK(countOf(pixels) > 2 * sharp);
  std::size_t shining = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    // A tenth of the lens sees the lamp of 15 W/(sr m2).
    if (reference.layers.at("direct").values()[3 * i] < 1.5f) continue;
    shining += 1;
    CHECK(int{pixels[i]} == 1);
  }
  CHECK(shining > sharp / 2);
  // Half of the lens sees the sky past the panel's edge, and more beyond.
  SceneBuilder dark = panel(true);
  for (Material& material : dark.scene.materials) material.emission = glm::vec3(0.0f);
  dark.scene.environment = glm::vec3(0.1f);
  dark.scene.cameras.front().aperture = 0.1;
  dark.scene.cameras.front().focus = 0.5;
  const std::size_t sky = countOf(emittingPixels(dark.scene, snapshotOf(dark.scene, 0.0)));
  CHECK(sky > 1100);
  CHECK(sky < 1300);
}
