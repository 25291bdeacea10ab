// The way back: virtual content shades and lights the real surfaces of the picture.
#include <cmath>
#include <filesystem>

#include "lumivox/base/file.h"
#include "lumivox/scene/text.h"
#include "support/captured_scenes.h"
#include "support/captures.h"
#include "support/facts.h"
#include "support/kept_table.h"
#include "support/virtual_area_lights.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Pipeline bothWays() {
  return pipeline("captured_frames");
}
Pipeline oneWay() {
  return pipeline("captured_frames/captured_frames_one_way");
}

/// A frame at the picture's size.
ImageBuffer finalOf(const Scene& scene, const Picture& picture, const Pipeline& text,
                    const std::vector<std::string>& settings) {
  return pictured(scene, picture, text, settings).outputs.at("final");
}

/// The real room alone, from where the picture was taken.
Scene roomOf(const Scene& scene) {
  const Capture& capture = *scene.captures.at(0);
  return seenBy(capture, capture.frames.front(), *capture.realScene);
}

/// Which pixels show real surfaces, and their neighbours too: at an edge a pixel of the truth is a mean of
/// both sides, a pixel of ours one of them.
std::vector<bool> realPixels(const Scene& scene, const Picture& picture) {
  const auto depthsOf = [&](const Scene& of) {
    return seenDepths(of, snapshotOf(of, 0.0, {}, picture.width, picture.height), 0.0).depth;
  };
  const std::vector<float> real = depthsOf(roomOf(scene)), front = depthsOf(scene);
  const auto isReal = [&](int x, int y) {
    const auto i = static_cast<std::size_t>(y * picture.width + x);
    return real[i] > 0.0f && (front[i] == 0.0f || front[i] > 1.001f * real[i]);
  };
  std::vector<bool> result(real.size(), false);
  for (int y = 1; y + 1 < picture.height; ++y)
    for (int x = 1; x + 1 < picture.width; ++x) {
      bool all = true;
      for (int i = 0; i < 9; ++i) all = all && isReal(x + i % 3 - 1, y + i / 3 - 1);
      result[static_cast<std::size_t>(y * picture.width + x)] = all;
    }
  return result;
}

struct Change {
  double error;  ///< RMSE of the change of real pixels over that of leaving it out
  double ratio;  ///< of the sums of changes, ours over the truth's
};

/// The change that virtual content makes to real pixels: ours is `changed` - `plain`.
Change changeOf(const Scene& scene, const Picture& picture, const ImageBuffer& plain,
                const ImageBuffer& changed) {
  // Other random numbers, so that the noise of both adds up.
  const LayeredImage with = truthOf(scene, picture), without = truthOf(roomOf(scene), picture, 0.0, 2);
  const std::vector<bool> real = realPixels(scene, picture);
  double error = 0.0, none = 0.0, ours = 0.0, theirs = 0.0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      if (!real[static_cast<std::size_t>(y * picture.width + x)]) continue;
      for (int c = 0; c < 3; ++c) {
        const auto at = [&](const LayeredImage& image, const char* layer) {
          return static_cast<double>(image.layers.at(layer).at(x, y, c));
        };
        const double truth = at(with, "full") - at(without, "full"),
                     noise = at(with, "full.variance") + at(without, "full.variance"),
                     own = static_cast<double>(changed.at(x, y, c)) - static_cast<double>(plain.at(x, y, c));
        error += (own - truth) * (own - truth) - noise;
        none += truth * truth - noise;
        ours += own;
        theirs += truth;
      }
    }
  return {std::sqrt(std::max(0.0, error) / none), ours / theirs};
}

}  // namespace

TEST_CASE("real surfaces lie on the view's rays in the planes that were captured, and are white") {
  const double slant = 0.6;
  const Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0, slant)}));
  // More pixels than the picture has: each shows the plane where its own ray meets it.
  const glm::ivec2 size(120, 80);
  const CameraView view = snapshotOf(scene, 0.0, {}, size.x, size.y).camera;
  LonePass pass("captured_frames.surfaces", scene, {}, snapshotOf(scene, 0.0, {}, size.x, size.y));
  const GBuffer seen = pass.in("frames", read(scene))
                           .in("map", lightsIn(scene, {{"filter", 0}}).value)
                           .out<GBuffer>("gbuffer");
  const std::vector<float> position = seen.position->downloadFloats(0),
                           normal = seen.normal->downloadFloats(0), white = seen.diffuse->downloadFloats(0);
  const glm::vec3 expected(static_cast<float>(std::sin(slant)), 0.0f, static_cast<float>(std::cos(slant)));
  REQUIRE(position.size() == 4u * 120u * 80u);
  for (int y = 2; y < size.y - 2; ++y)
    for (int x = 2; x < size.x - 2; ++x) {
      const auto i = static_cast<std::size_t>(4 * (y * size.x + x));
      const glm::vec3 place(position[i], position[i + 1], position[i + 2]);
      REQUIRE(position[i + 3] == 1.0f);
      REQUIRE(std::abs(glm::dot(place - glm::vec3(0, 0, -2), expected)) < 1e-4f);
      const glm::vec3 ray = view.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      REQUIRE(glm::length(glm::cross(glm::normalize(place - view.eye), glm::normalize(ray))) < 1e-4f);
      REQUIRE(glm::dot(glm::vec3(normal[i], normal[i + 1], normal[i + 2]), expected) > 0.9999f);
      REQUIRE(white[i] == 1.0f);
    }
}

TEST_CASE("a hole of the sensor takes the surface beside it, and a wide one none") {
  const CaptureCamera camera = smallCamera();
  const auto seen = [&](const glm::dvec2& ray) {
    const glm::ivec2 at(glm::round(camera.project(ray)));
    const bool hole = at == glm::ivec2(20, 20) || at.x >= 40;
    return SeenPixel{hole ? 0.0 : 2.0, glm::vec3(1.0f)};
  };
  const Scene scene = sceneWith(captureOf(camera, {seen}));
  const GBuffer surfaces = surfacesIn(scene);
  const std::vector<float> position = surfaces.position->downloadFloats(0);
  const auto at = [&](int x, int y) {
    return glm::vec2(position[4u * static_cast<unsigned>(60 * y + x) + 2u],
                     position[4u * static_cast<unsigned>(60 * y + x) + 3u]);
  };
  CHECK(at(20, 20).x == Approx(-2.0f).epsilon(1e-4));
  CHECK(at(20, 20).y == 1.0f);
  CHECK(at(50, 20).y == 0.0f);
}

TEST_CASE("across a hole a plane is continued by 5 % of the distance, and no farther") {
  // A slanted wall, of which three columns are missing: in the middle one the nearest pixel is two away.
  const CaptureCamera camera = smallCamera();
  const double slant = GENERATE(0.5, 0.91);
  const auto wall = plane(2.0, slant);
  const auto seen = [&](const glm::dvec2& ray) {
    const glm::ivec2 at(glm::round(camera.project(ray)));
    return at.x >= 20 && at.x <= 22 ? SeenPixel{0.0, glm::vec3(1.0f)} : wall(ray);
  };
  const std::vector<float> position =
      surfacesIn(sceneWith(captureOf(camera, {seen}))).position->downloadFloats(0);
  const auto depthAt = [&](int x) { return -position[4u * static_cast<unsigned>(60 * 20 + x) + 2u]; };
  // From column 19 to 21 the ray turns by 0.04: 3 % and 6 % of the distance on the walls.
  const double continued = wall(camera.ray({21, 20})).depth, kept = wall(camera.ray({19, 20})).depth;
  CHECK(depthAt(21) == Approx(slant < 0.6 ? continued : kept).epsilon(1e-3));
}

TEST_CASE("the picture is multiplied by irradiance with virtual content over that without, between 0 and 8") {
  const Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0, 0.0, glm::vec3(3.0f, 2.0f, 1.0f))}));
  const auto image = [&](const glm::vec4& value) { return Image{filled(pixels(60, 40), value)}; };
  const auto shownWith = [&](const glm::vec4& before, const glm::vec4& after, const glm::vec4& added) {
    LonePass pass("captured_frames.composite", scene);
    pass.in("gbuffer", gbufferAt({.hit = false}, {60, 40}))
        .in("virtual", image(glm::vec4(7.0f)))
        .in("frames", read(scene))
        .in("before", image(before))
        .in("after", image(after));
    if (added != glm::vec4(0.0f)) pass.in("added", image(added));
    const ImageBuffer result = pass.image("radiance");
    return glm::vec3(result.at(30, 20, 0), result.at(30, 20, 1), result.at(30, 20, 2));
  };
  const auto near = [](const glm::vec3& a, const glm::vec3& b) { return glm::length(a - b) < 1e-5f; };
  CHECK(near(shownWith({2, 2, 2, 1}, {1, 2, 0, 1}, glm::vec4(0)), {1.5f, 2.0f, 0.0f}));
  CHECK(near(shownWith({2, 2, 2, 1}, {1, 2, 0, 1}, {1, 1, 1, 1}), {3.0f, 3.0f, 0.5f}));
  CHECK(near(shownWith({1e-3f, 0, 1, 1}, {1, 5, 1, 1}, glm::vec4(0)), {24.0f, 2.0f, 1.0f}));
}

TEST_CASE("before virtual content nothing is relit, and without `before` and `after` nothing at all") {
  Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0)}));
  const auto image = [&](float value) { return Image{filled(pixels(60, 40), glm::vec4(value))}; };
  // A virtual wall at 1 m in the lower half.
  const GBuffer wall = gbufferWhere({60, 40}, [](int, int y) {
    SeenSurface one;
    one.position = {0.0f, 0.0f, -1.0f};
    one.hit = y >= 20;
    return one;
  });
  const auto shown = [&](bool relit) {
    LonePass pass("captured_frames.composite", scene);
    pass.in("gbuffer", wall).in("virtual", image(7.0f)).in("frames", read(scene));
    if (relit) pass.in("before", image(1.0f)).in("after", image(0.5f));
    return pass.image("radiance");
  };
  const ImageBuffer relit = shown(true), plain = shown(false);
  CHECK(relit.at(30, 10, 0) == 0.5f);
  CHECK(relit.at(30, 30, 0) == 7.0f);
  CHECK(plain.at(30, 10, 0) == 1.0f);
  CHECK(plain.at(30, 30, 0) == 7.0f);
}

TEST_CASE("a plate casts its shadow on a captured floor: direct light is gone there, and nowhere else") {
  // A wall 2 m before the eye, lit along the view by a sun; a plate of 0.4 m at 1 m hides a part of it, which
  // the eye sees from beside the sun's direction.
  const glm::vec3 radiance(0.5f);
  SceneBuilder builder;
  builder.quad({-0.2, -0.2, -1.0}, {0.4, 0, 0}, {0, 0.4, 0}, builder.lambert(0.5f));
  builder.light(LightKind::directional, glm::vec3(1.0f), glm::dvec3(0),
                glm::normalize(glm::dvec3(0.6, 0, -1)));
  const Scene captured = sceneWith(captureOf(smallCamera(160, 120, 130.0), {plane(2.0, 0.0, radiance)}));
  Scene scene = builder.scene;
  scene.cameras = captured.cameras, scene.captures = captured.captures;
  const ImageBuffer plain = finalOf(scene, {160, 120}, oneWay(), {"filter=0"}),
                    relit = finalOf(scene, {160, 120}, bothWays(), {"filter=0", "stride=4"});
  // The plate's middle (0, 0, -1) is carried along (0.6, 0, -1) to (0.6, 0, -2): pixel 79.5 + 130 * 0.3.
  const int x = 118, y = 60;
  CHECK(plain.at(x, y, 0) == 0.5f);
  // What is left is the wall's own light on itself, of which a plane receives none: none before, none after.
  CHECK(relit.at(x, y, 0) < 0.02f);
  CHECK(relit.at(x, 10, 0) == Approx(0.5f).epsilon(0.01));
  CHECK(relit.at(20, y, 0) == Approx(0.5f).epsilon(0.01));
}

TEST_CASE("captured lights in a shadow are dimmed, and lights that the view does not show keep their flux") {
  const Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0)}));
  // In the left half a quarter of the light is left, in green a half of it.
  const auto after = pixelsWhere(
      {60, 40}, [](int x, int) { return x < 30 ? glm::vec4(0.5f, 1.0f, 2.0f, 1.0f) : glm::vec4(2.0f); });
  const auto lit = [](const glm::vec3& place) {
    return DiscLight{.position = place, .normal = {0, 0, 1}, .area = 1.0f, .exitance = glm::vec3(8.0f)};
  };
  LonePass pass("captured_frames.relight", scene);
  const SurfaceLights lights =
      pass.in("lights", lightsOf({lit({-0.5f, 0, -2}), lit({0.5f, 0, -2}), lit({-0.5f, 0, -3}),
                                  lit({-0.5f, 0, 2}), lit({-9, 0, -2})}))
          .in("gbuffer", surfacesIn(scene))
          .in("before", Image{filled(pixels(60, 40), glm::vec4(2.0f))})
          .in("after", Image{after})
          .out<SurfaceLights>("lights");
  REQUIRE(lights.count == 5);
  const auto values = lights.lights->downloadValues<float>();
  const auto fluxOf = [&](std::size_t i) {
    return glm::vec3(values[12 * i + 8], values[12 * i + 9], values[12 * i + 10]);
  };
  CHECK(fluxOf(0) == glm::vec3(2, 4, 8));
  CHECK(fluxOf(1) == glm::vec3(8));
  CHECK(fluxOf(2) == glm::vec3(8));  // behind the surface that the view shows
  CHECK(fluxOf(3) == glm::vec3(8));  // behind the eye
  CHECK(fluxOf(4) == glm::vec3(8));  // beside the picture
}

TEST_CASE("virtual content changes the light of real pixels as the truth does, better than leaving it out") {
  const Picture picture{80, 60, 64};
  const Scene scene = committed("mixed_reality");
  const Change change = changeOf(scene, picture, finalOf(scene, picture, oneWay(), {}),
                                 finalOf(scene, picture, bothWays(), {}));
  INFO("RMSE over none " << change.error << ", sum " << change.ratio);
  CHECK(change.error < 0.5);
  CHECK(change.ratio > 0.7);
  CHECK(change.ratio < 1.3);
}

TEST_CASE("real pixels far from anything virtual stay as they are within 1 %") {
  const std::filesystem::path folder = sourceDirectory() / "scenes";
  std::string text = readFile(folder / "mixed_reality.scene");
  // A marble in a corner of the floor in place of the three objects.
  const std::size_t begin = text.find("  mesh sphere");
  text =
      text.substr(0, begin) +
      "  mesh sphere { file \"models/sphere.obj\"  material clay  crease 180 deg  scale 2 cm  translate 0.47 0.001 0.14 }\n}\n";
  const Scene scene = loadSceneText(text, folder / "marble.scene");
  const Picture picture{80, 60};
  const ImageBuffer plain = finalOf(scene, picture, oneWay(), {}),
                    relit = finalOf(scene, picture, bothWays(), {});
  double changed = 0.0, all = 0.0, near = 0.0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double before = static_cast<double>(plain.at(x, y, 1)),
                   after = static_cast<double>(relit.at(x, y, 1));
      const bool isFar = x > 40 || y < 35;
      near = std::max(near, isFar ? 0.0 : std::abs(after - before));
      if (!isFar || before == 0.0) continue;
      CAPTURE(x, y);
      CHECK(after == Approx(before).epsilon(0.05));  // each, and in the mean:
      changed += std::abs(after - before);
      all += before;
    }
  CHECK(changed / all < 0.01);
  CHECK(near > 0.01);
}

// The numbers of the card; minutes.
TEST_CASE("errors of the way back", "[.]") {
  const Picture picture{160, 120, 512};
  KeptTable table("captured_frames.way_back", {{"change of real pixels", 3, 0.03}, {"its sum", 2, 0.05}});
  const Scene scene = committed("mixed_reality"),
              clean = withImages(scene, exactImages(*scene.captures.at(0), 512));
  const auto row = [&](const std::string& name, const Scene& shown,
                       const std::vector<std::string>& settings) {
    const std::vector<std::string> shared =
        &shown == &clean ? std::vector<std::string>{"brightest=1"} : std::vector<std::string>{};
    std::vector<std::string> all = shared;
    all.insert(all.end(), settings.begin(), settings.end());
    const Change change = changeOf(scene, picture, finalOf(shown, picture, oneWay(), shared),
                                   finalOf(shown, picture, bothWays(), all));
    table.row(name, {change.error, change.ratio});
    CAPTURE(name, change.ratio);
    CHECK(change.error <= 0.8);
    CHECK((change.ratio > 0.5 && change.ratio < 1.2));
  };
  row("one picture", scene, {});
  row("one picture, exact", clean, {});
  for (const char* stride : {"2", "4", "16"})
    row(std::string("one picture, stride ") + stride, scene, {std::string("stride=") + stride});
}
