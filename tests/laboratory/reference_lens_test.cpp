// The thin lens of the path tracer. A point at depth d, seen through a lens of diameter A that is focused on
// depth f, meets the plane in focus in a disc of diameter A |d - f| / d: the circle of confusion, here in
// pixels. Its variance along an axis is a sixteenth of the square of its diameter.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "lumivox/reference/path_tracer.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSize = 32;          // pixels along both sides
constexpr double kFov = 0.4;       // rad
constexpr float kRadiance = 3.0f;  // of the lamp, W/(sr m^2)
constexpr double kFocus = 2.0;     // m

/// Pixels per metre in the plane in focus.
double pixelsPerMetre() {
  return kSize / (2.0 * std::tan(0.5 * kFov) * kFocus);
}

/// A square lamp that is `width` pixels wide in the image, at depth `depth` in front of the camera.
Scene lampAt(double depth, double width, double aperture) {
  SceneBuilder builder;
  const auto side = static_cast<float>(width / pixelsPerMetre() * depth / kFocus);
  const auto z = static_cast<float>(-depth);
  builder.quad({-0.5f * side, -0.5f * side, z}, {side, 0, 0}, {0, side, 0}, builder.lambert(0.0f, kRadiance));
  Camera& camera = builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFov, kSize, kSize);
  camera.aperture = aperture;
  camera.focus = kFocus;
  return builder.scene;
}

struct Blot {
  double energy = 0.0;    ///< sum of the radiances of all pixels
  double variance = 0.0;  ///< along x, pixels^2
  double reach = 0.0;     ///< of the farthest pixel with light from the middle, pixels
};
Blot blotOf(const ImageBuffer& image) {
  Blot blot;
  double second = 0.0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double value = image.at(x, y, 0), dx = x + 0.5 - 0.5 * kSize, dy = y + 0.5 - 0.5 * kSize;
      blot.energy += value;
      second += value * dx * dx;
      if (value > 0.0) blot.reach = std::max(blot.reach, std::hypot(dx, dy));
    }
  blot.variance = second / blot.energy;
  return blot;
}

}  // namespace

TEST_CASE("a lamp out of focus is as wide as its circle of confusion and keeps its energy") {
  constexpr double kLamp = 3.0, kAperture = 0.25;
  for (const double depth : {1.2, 1.6, 3.0, 6.0}) {
    CAPTURE(depth);
    const double circle = kAperture * std::abs(depth - kFocus) / depth * pixelsPerMetre();
    REQUIRE(circle > 2.0);
    const Blot blot =
        blotOf(renderReference(lampAt(depth, kLamp, kAperture), quietly(1024, 0)).layers.at("direct"));
    // All points of the lens see the lamp equally large in the plane in focus.
    CHECK(blot.energy == Approx(kRadiance * kLamp * kLamp).epsilon(0.02));
    // The lamp's square, smeared by the disc and by the pixel's own square.
    const double variance = kLamp * kLamp / 12.0 + circle * circle / 16.0 + 1.0 / 12.0;
    CHECK(blot.variance == Approx(variance).epsilon(0.03));
    CHECK(blot.reach <= 0.5 * circle + kLamp / std::sqrt(2.0) + 1.0);
  }
}

TEST_CASE("what lies in the plane in focus is as sharp as through a pinhole") {
  // The edges of the lamp are edges of pixels, so that every pixel is all lamp or none.
  const ImageBuffer image = renderReference(lampAt(kFocus, 8.0, 0.3), quietly(64, 0)).layers.at("direct");
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      CAPTURE(x, y);
      const bool inside = std::abs(x + 0.5 - 0.5 * kSize) < 4.0 && std::abs(y + 0.5 - 0.5 * kSize) < 4.0;
      CHECK(image.at(x, y, 0) == Approx(inside ? kRadiance : 0.0f).margin(0.01 * kRadiance));
    }
}

TEST_CASE("without an aperture a focus changes no bit, and with one the reference is another") {
  Scene pinhole = litRoom(12, 10), focused = pinhole, lens = pinhole;
  focused.cameras.front().focus = 1.5;
  lens.cameras.front().focus = 1.5;
  lens.cameras.front().aperture = 0.05;
  const auto image = [](const Scene& scene) {
    return renderReference(scene, quietly(4, 2)).layers.at("full").values();
  };
  CHECK(image(focused) == image(pinhole));
  CHECK(image(lens) != image(pinhole));

  const TemporaryDirectory directory;
  setenv("LUMIVOX_CACHE", directory.path().c_str(), 1);
  const auto entries = [&](const Scene& scene) {
    ReferenceOptions options = quietly(4, 2);
    options.useCache = true;
    cachedReference(scene, options);
    return std::distance(std::filesystem::directory_iterator(directory.path()), {});
  };
  CHECK(entries(pinhole) == 1);
  CHECK(entries(focused) == 1);
  CHECK(entries(lens) == 2);
  Scene farther = lens, wider = lens;
  farther.cameras.front().focus = 1.6;
  wider.cameras.front().aperture = 0.06;
  CHECK(entries(farther) == 3);
  CHECK(entries(wider) == 4);
  unsetenv("LUMIVOX_CACHE");
}
