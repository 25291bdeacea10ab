// Occlusion and light from what the camera sees, against closed forms: scenes and g-buffers so small that
// both are known.
#include <cmath>
#include <functional>

#include "lumivox/base/error.h"
#include "support/against_reference.h"
#include "support/facts.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A point in the first pixel of an image whose others all see one surface, which lies at `position` and
/// sends this radiance; without a surface where `seen` says so. The camera looks along -z from (0, 0, 5) and
/// sees the ball of radius 1 m around the origin away from the first pixel.
struct OneSurface {
  glm::vec3 position{0.0f}, normal{0.0f}, radiance{1.0f}, emission{0.0f};
  glm::vec3 receiverNormal{0.0f, 1.0f, 0.0f}, receiver{0.0f};
  float environment = 0.0f;
  glm::vec2 shift{0.0f};
  std::function<bool(int, int)> seen = [](int, int) { return true; };
};
constexpr int kSide = 16;

/// What reaches the point, by a pass with these settings; of `frames` frames that accumulate.
glm::vec3 received(const OneSurface& made, const char* pass, const Settings& settings, int frames = 1,
                   std::uint64_t seed = 1) {
  SceneBuilder builder;
  builder.scene.environment = glm::vec3(made.environment);
  builder.look({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.7, kSide, kSide);
  SceneSnapshot snapshot = snapshotOf(builder.scene, 0.0);
  snapshot.camera.shift = made.shift;
  const auto image = [&](const glm::vec3& first, const glm::vec3& others, bool marksSurfaces = false) {
    return pixelsWhere({kSide, kSide}, [&](int x, int y) {
      const bool isFirst = x == 0 && y == 0, hit = isFirst || made.seen(x, y);
      return glm::vec4(isFirst ? first : others, marksSurfaces && !hit ? 0.0f : 1.0f);
    });
  };
  GBuffer gbuffer;
  gbuffer.position = image(made.receiver, made.position, true);
  gbuffer.normal = gbuffer.geometricNormal = image(made.receiverNormal, made.normal);
  gbuffer.diffuse = image(glm::vec3(0.5f), glm::vec3(0.5f));
  if (made.emission != glm::vec3(0.0f)) gbuffer.emission = image({}, made.emission);
  LonePass lone(std::string("screen_space.") + pass, builder.scene, {{"radius", 1.0}}, snapshot);
  lone.in("gbuffer", gbuffer).with(settings);
  const bool isLight = pass == std::string("ssdo");
  if (isLight) lone.in("direct", Image{image({}, made.radiance + made.emission)});
  if (frames > 1) lone.harness().accumulate();
  for (int frame = 0; frame < frames; ++frame) lone.run(seed);
  const ImageBuffer result = lone.image(isLight ? "arriving" : "occlusion");
  return {result.at(0, 0, 0), result.at(0, 0, 1), result.at(0, 0, 2)};
}

/// A wall at this distance before the point, through which the camera sees everything behind it.
OneSurface wallAt(float distance, float height = 0.0f) {
  OneSurface wall;
  wall.position = {distance, height, 0.0f};
  wall.normal = {-1.0f, 0.0f, 0.0f};
  return wall;
}

/// Mean of a function of a number that is even over [0, 1].
double meanOver(const std::function<double(double)>& function) {
  constexpr int kSteps = 20000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) sum += function((i + 0.5) / kSteps);
  return sum / kSteps;
}

/// Share of cosine-distributed directions whose component along an axis in the plane is above c: they are
/// even over the unit disc, of which a segment is cut off.
double discSegment(double c) {
  return c >= 1.0 ? 0.0 : (std::acos(c) - c * std::sqrt(1.0 - c * c)) / kPi;
}

/// The same of directions that are even over the hemisphere: half the cap, of the whole sphere's half.
double capShare(double c) {
  return c >= 1.0 ? 0.0 : 0.5 * (1.0 - c);
}

/// A floor before a wall, long and high, seen from before both.
SceneBuilder floorAndWall() {
  SceneBuilder builder;
  builder.quad({-20, 0, 0}, {0, 0, 6}, {40, 0, 0}, builder.lambert(0.5f));
  builder.quad({-20, 0, 0}, {40, 0, 0}, {0, 20, 0}, builder.lambert(0.5f));
  builder.look({0, 1.6, 3}, {0, 0.3, 0.3}, {0, 1, 0}, 1.4, 64, 64);
  return builder;
}

/// Occlusion of a scene by the pass alone; and where its points lie.
struct Seen {
  ImageBuffer occlusion, position;
};
Seen occlusionOf(const Scene& scene, const Settings& settings) {
  const GBuffer gbuffer = gbufferOf(scene);
  return {LonePass("screen_space.ssao", scene, settings).in("gbuffer", gbuffer).image("occlusion", 1),
          imageOf(*gbuffer.position, 4)};
}

}  // namespace

TEST_CASE("a plane at any tilt is not occluded, whatever the number of samples") {
  for (const char* directions : {"sphere", "hemisphere"})
    for (const int samples : {16, 7, 1})
      for (int i = 0; i < 10; ++i) {
        SceneBuilder builder;
        const double tilt = 0.15 * i;
        const auto up = static_cast<float>(std::sin(tilt)), along = static_cast<float>(std::cos(tilt));
        builder.quad({-30, -10 * along, 10 * up}, {60, 0, 0}, {0, 20 * along, -20 * up},
                     builder.lambert(0.5f));
        builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, 32, 32);
        const Seen seen =
            occlusionOf(builder.scene, {{"radius", 0.5}, {"directions", directions}, {"samples", samples}});
        CAPTURE(directions, samples, tilt);
        for (const float value : seen.occlusion.values()) CHECK(value == 1.0f);
      }
}

TEST_CASE("before a long wall the sphere's share is that of the cap behind it: 1 - (1 - t)^2 (2 + t) / 4") {
  // Of the ball's volume 4 pi / 3 the cap has pi (1 - t)^2 (2 + t) / 3, half of it above the floor; the open
  // share counts twice, since all below the floor is hidden.
  struct Run {
    int samples;
    const char* range;
    double tolerance;
  };
  for (const auto& [samples, range, tolerance] :
       {Run{1024, "on", 0.01}, {1024, "off", 0.01}, {4, "on", 0.05}, {3, "on", 0.05}})
    for (const glm::vec2 bin : {glm::vec2(0.05f, 0.3f), {0.3f, 0.6f}, {0.6f, 0.95f}}) {
      const Seen seen =
          occlusionOf(floorAndWall().scene, {{"radius", 1}, {"samples", samples}, {"range", range}});
      double measured = 0.0, expected = 0.0;
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
          const double t = seen.position.at(x, y, 2);
          if (std::abs(seen.position.at(x, y, 0)) > 0.5f || t < bin.x || t > bin.y) continue;
          measured += seen.occlusion.at(x, y, 0);
          expected += 1.0 - (1.0 - t) * (1.0 - t) * (2.0 + t) / 4.0;
        }
      CAPTURE(samples, range, bin.x, measured / expected);
      CHECK(measured == Approx(expected).epsilon(tolerance));
    }
}

TEST_CASE(
    "by the cosine a wall at distance d hides the segment of the disc beyond d / s at each distance s") {
  for (const float d : {0.1f, 0.4f, 0.8f}) {
    // Points are even by volume: s is the cube root of an even number.
    const double hidden = meanOver([&](double v) { return discSegment(d / std::cbrt(v)); });
    const glm::vec3 open = received(wallAt(d), "ssao", {{"directions", "hemisphere"}, {"samples", 4096}});
    CAPTURE(d);
    CHECK(open.x == Approx(1.0 - hidden).epsilon(0.01));
  }
}

TEST_CASE(
    "as published the depth of a pixel hides what is farther along the view, not what is behind a plane") {
  // The wall's pixels lie in the plane z = 0 through the point: half of the ball is beyond that.
  for (const float d : {0.4f, 2.0f})
    CHECK(received(wallAt(d), "ssao",
                   {{"directions", "hemisphere"}, {"samples", 4096}, {"surface", "depth"}, {"range", "off"}})
              .x == Approx(0.5).epsilon(0.01));
  CHECK(received(wallAt(2.0f), "ssao", {{"directions", "hemisphere"}, {"samples", 256}}).x == 1.0f);
  for (const float z : {-2.0f, 2.0f}) {
    OneSurface wall = wallAt(0.4f);
    wall.position.z = z;
    CHECK(received(wall, "ssao", {{"directions", "hemisphere"}, {"surface", "depth"}, {"range", "off"}}).x ==
          (z < 0.0f ? 1.0f : 0.0f));
  }
}

TEST_CASE("something farther before the point than the radius hides it only where the range is off") {
  for (const float before : {0.9f, 1.1f}) {
    OneSurface column;  // faces the camera, across the whole view
    column.position = {0, 0, before};
    column.normal = {0, 0, 1};
    for (const char* directions : {"sphere", "hemisphere"}) {
      Settings settings{{"directions", directions}, {"samples", 64}};
      // The points below the surface, half of the sphere's, stay hidden by the surface itself.
      CHECK(received(column, "ssao", settings).x == (before > 1.0f ? 1.0f : 0.0f));
      settings.emplace_back("range", "off");
      CHECK(received(column, "ssao", settings).x == 0.0f);
    }
  }
}

TEST_CASE("a convex edge is no brighter than a plane") {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(0.5f), false);
  builder.look({2, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.9, 32, 32);
  const Seen seen = occlusionOf(builder.scene, {{"samples", 64}});
  for (const float value : seen.occlusion.values()) CHECK(value <= 1.0f);
}

TEST_CASE("what lies outside of the view or behind the camera hides nothing and sends nothing") {
  for (const glm::vec3 receiver : {glm::vec3(50, 0, 0), {0, 0, 9}}) {
    OneSurface wall = wallAt(0.01f);
    wall.position = receiver;
    wall.receiver = receiver - glm::vec3(0.01f, 0, 0);
    wall.environment = 2.0f;
    CHECK(received(wall, "ssao", {{"directions", "hemisphere"}, {"surface", "depth"}}).x == 1.0f);
    CHECK(received(wall, "ssdo", {}).x == Approx(2.0f).epsilon(1e-5));
  }
}

TEST_CASE("where the image plane is shifted, points are looked up as far beside") {
  // The right half sees a screen before everything. A ball that is small against a pixel lies between both.
  const auto open = [](float shift, int firstColumn = kSide / 2) {
    OneSurface made;
    made.position = {0, 0, 1};
    made.normal = {0, 0, 1};
    made.seen = [firstColumn](int x, int) { return x >= firstColumn; };
    made.shift = {shift, 0};
    return received(made, "ssao",
                    {{"directions", "hemisphere"}, {"samples", 1024}, {"radius", 0.01}, {"range", "off"}})
        .x;
  };
  CHECK(open(0.0f) == Approx(0.5).margin(0.01));
  CHECK(open(3.0f) == 1.0f);
  CHECK(open(-3.0f) == 0.0f);
  // Just inside of the image's edges and just outside.
  CHECK(open(7.9f, 0) == 0.0f);
  CHECK(open(8.1f, 0) == 1.0f);
  CHECK(open(-7.9f, 0) == 0.0f);
  CHECK(open(-8.1f, 0) == 1.0f);
}

TEST_CASE("a radius of 0 is the distance at which the reference looks for what occludes") {
  SceneBuilder builder = floorAndWall();
  const double distance = ambientOcclusionDistance(snapshotOf(builder.scene, 0.0).bounds);
  const Seen own = occlusionOf(builder.scene, {{"radius", 0}, {"directions", "hemisphere"}}),
             given = occlusionOf(builder.scene, {{"radius", distance}, {"directions", "hemisphere"}});
  double difference = 0.0, occluded = 0.0;
  for (std::size_t i = 0; i < own.occlusion.values().size(); ++i) {
    difference += std::abs(own.occlusion.values()[i] - given.occlusion.values()[i]);
    occluded += 1.0 - own.occlusion.values()[i];
  }
  CHECK(occluded > 100.0);
  CHECK(difference < 1e-3 * occluded);
}

TEST_CASE("a plane in light of radiance L from all sides reflects rho L, with any even number of samples") {
  SceneBuilder builder;
  builder.scene.environment = {1.0f, 2.0f, 3.0f};
  builder.quad({-9, 0, -9}, {0, 0, 18}, {18, 0, 0}, builder.lambert(0.25f));
  builder.look({0, 2, 1}, {0, 0, 0}, {0, 1, 0}, 0.7, 16, 16);
  for (const char* pixels : {"pixels=full", "pixels=half", "pixels=quarter"})
    for (const char* samples : {"samples=2", "samples=16", "samples=64"}) {
      const ImageBuffer image =
          rendered(builder.scene, pipeline("screen_space"), {pixels, samples, "radius=0.5m"})
              .outputs.at("indirect_diffuse");
      for (int c = 0; c < 3; ++c)
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x) CHECK(image.at(x, y, c) == Approx(0.25 * (c + 1)).epsilon(1e-5));
    }
  // With an odd number the one in the middle has no neighbour: its noise is 2 / (N sqrt(12 N^2)) of L.
  const ImageBuffer image = rendered(builder.scene, pipeline("screen_space"), {"samples=3", "radius=0.5m"})
                                .outputs.at("indirect_diffuse");
  double mean = 0.0;
  for (int i = 0; i < 256; ++i) mean += image.at(i % 16, i / 16, 0) / 256.0;
  CHECK(mean == Approx(0.25).epsilon(0.02));
}

TEST_CASE("a wall of radiance L sends 2 L times the cosines of the directions that it blocks") {
  // Directions are even over the hemisphere and distances even: behind a wall at distance d lie those with
  // s w_x > d. The mean cosine of the directions with w_x > c is that of the disc's segment, halved: their
  // density by the cosine is 2 cos.
  for (const float d : {0.1f, 0.4f, 0.8f}) {
    const double expected = meanOver([&](double s) { return discSegment(d / s); });
    OneSurface wall = wallAt(d);
    wall.radiance = {1.0f, 2.0f, 4.0f};
    const glm::vec3 found = received(wall, "ssdo", {{"samples", 4096}});
    for (int c = 0; c < 3; ++c) CHECK(found[c] == Approx(expected * wall.radiance[c]).epsilon(0.02));
    // And the environment comes by all others.
    wall.environment = 3.0f;
    CHECK(received(wall, "ssdo", {{"samples", 4096}}).x ==
          Approx(expected + 3.0 * (1.0 - expected)).epsilon(0.01));
  }
}

TEST_CASE("as published each blocked direction sends L cos cos / (pi d^2) of the area pi r^2 / N") {
  for (const float d : {0.1f, 0.4f}) {
    constexpr float kHeight = 0.3f;
    const double blocked = meanOver([&](double s) { return capShare(d / s); });
    const double distance2 = d * d + kHeight * kHeight;
    const double expected = blocked * (kHeight * d / distance2) / distance2;
    OneSurface wall = wallAt(d, kHeight);
    const glm::vec3 found = received(wall, "ssdo", {{"samples", 4096}, {"area", "published"}});
    CHECK(found.x == Approx(expected).epsilon(0.02));
  }
}

TEST_CASE("as published what is nearer than a hundredth of the radius counts as that far away") {
  // The nearest sender, at a slant of 45 degrees: cos cos = 1 / 2 and nearly half of the directions blocked.
  for (const float d : {1e-3f, 1e-5f}) {
    const glm::vec3 found = received(wallAt(d, d), "ssdo", {{"samples", 4096}, {"area", "published"}});
    CHECK(found.x == Approx(0.5 * 0.5 * 1e4).epsilon(0.03));
  }
  // In the very place nothing has a direction.
  for (const char* area : {"published", "solid_angle"})
    CHECK(received(wallAt(0.0f), "ssdo", {{"samples", 64}, {"area", area}}) == glm::vec3(0.0f));
}

TEST_CASE("a surface sends nothing to what lies behind it, nor what it emits") {
  for (const char* area : {"published", "solid_angle"}) {
    OneSurface screen;  // before the point, turned to the camera and away from it
    screen.position = {0.2f, 0.2f, 0.2f};
    screen.normal = {0, 0, 1};
    CHECK(received(screen, "ssdo", {{"area", area}}) == glm::vec3(0.0f));
    OneSurface lamp = wallAt(0.3f, 0.3f);
    const glm::vec3 dark = received(lamp, "ssdo", {{"area", area}});
    CHECK(dark.x > 0.01f);
    lamp.emission = {8.0f, 4.0f, 2.0f};  // exact in binary: what is left is the same to the bit
    CHECK(received(lamp, "ssdo", {{"area", area}}) == dark);
  }
}

TEST_CASE(
    "one result for 2 x 2 or 4 x 4 pixels is that of the pixel in their middle, and one pixel has one") {
  const Scene scene = floorAndWall().scene;
  for (const int size : {64, 21, 1}) {
    Scene sized = scene;
    sized.cameras.front().width = sized.cameras.front().height = size;
    const Seen full = occlusionOf(sized, {{"radius", 1}});
    for (const auto& [word, every] : {std::pair("half", 2), std::pair("quarter", 4)}) {
      const Seen some = occlusionOf(sized, {{"radius", 1}, {"pixels", word}});
      REQUIRE(some.occlusion.width() == (size + every - 1) / every);
      REQUIRE(some.occlusion.height() == (size + every - 1) / every);
      const auto pixel = [&](int i) { return std::min(every * i + every / 2, size - 1); };
      for (int y = 0; y < some.occlusion.height(); ++y)
        for (int x = 0; x < some.occlusion.width(); ++x)
          CHECK(some.occlusion.at(x, y, 0) == full.occlusion.at(pixel(x), pixel(y), 0));
    }
  }
}

TEST_CASE("frames that accumulate have other points, and their mean goes to the right one") {
  const double expected = meanOver([&](double s) { return discSegment(0.4 / s); });
  double one = 0.0, many = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    one += std::pow(received(wallAt(0.4f), "ssdo", {}, 1, seed).x - expected, 2);
    many += std::pow(received(wallAt(0.4f), "ssdo", {}, 32, seed).x - expected, 2);
  }
  CAPTURE(std::sqrt(one / 12), std::sqrt(many / 12), expected);
  CHECK(many > 0.0);
  CHECK(std::sqrt(many) < 0.3 * std::sqrt(one));  // by 32 frames: a sixth
  // The first frame is that of a run that does not accumulate; a seed is one image.
  CHECK(received(wallAt(0.4f), "ssdo", {}, 1, 5) == received(wallAt(0.4f), "ssdo", {}, 1, 5));
  CHECK(received(wallAt(0.4f), "ssdo", {}, 1, 5) != received(wallAt(0.4f), "ssdo", {}, 1, 5ull << 32));
}

TEST_CASE("a scene of millimetres has the occlusion of the same scene in metres") {
  SceneBuilder small = floorAndWall();
  for (glm::vec3& position : small.scene.positions) position *= 1e-3f;
  small.scene.cameras.front().eye *= 1e-3;
  small.scene.cameras.front().target *= 1e-3;
  const Seen metres = occlusionOf(floorAndWall().scene, {{"radius", 1}}),
             millimetres = occlusionOf(small.scene, {{"radius", 0.001}});
  int different = 0;  // where rounding decides for one of a pixel's points
  for (std::size_t i = 0; i < metres.occlusion.values().size(); ++i)
    different += metres.occlusion.values()[i] != millimetres.occlusion.values()[i];
  CHECK(different < 10);
}

TEST_CASE("screen space refuses what it cannot take, and says what it expected") {
  const auto refused = [](const char* pass, const Setting& setting) {
    return messageOf<Error>([&] { received(wallAt(0.4f), pass, {setting}); });
  };
  for (const char* pass : {"ssao", "ssdo"}) {
    CHECK_THAT(refused(pass, {"radius", -1}), Tells("radius"));
    CHECK_THAT(refused(pass, {"samples", 0}), Tells("samples"));
    CHECK_THAT(refused(pass, {"samples", 5000}), Tells(4096));
    CHECK_THAT(refused(pass, {"pixels", "eighth"}), Tells("quarter"));
    CHECK_THAT(refused(pass, {"surface", "ray"}), Tells("plane"));
  }
  const Scene scene = floorAndWall().scene;
  LonePass ssdo("screen_space.ssdo", scene);
  ssdo.in("gbuffer", gbufferOf(scene)).in("direct", Image{filled(pixels(32, 64), glm::vec4(1.0f))});
  CHECK_THROWS_MATCHES(ssdo.run(), Error, Tells("direct", "32 x 64", "64 x 64", "gbuffer"));
}

TEST_CASE("screen space errs on the Cornell box and the arcade by what its card claims") {
  // Here in fewer pixels than there: a tenth above its RMSE, as a share of that of nothing, is allowed.
  struct Claim {
    const char* scene;
    double light, sphere, hemisphere;
  };
  for (const Claim& claim : {Claim{"cornell", 0.97, 0.66, 0.48}, {"arcade", 1.65, 0.91, 0.67}}) {
    const Scene scene = committed(claim.scene);
    const Picture picture{64, 36};
    const LayeredImage reference = referenceOf(scene, picture);
    const FrameResult frame = pictured(scene, picture, pipeline("screen_space"), {});
    const double light = lightAgainst(reference, frame.outputs.at("indirect_diffuse")).rmse,
                 sphere = occlusionAgainst(reference, frame.outputs.at("ambient_occlusion")).rmse,
                 hemisphere = occlusionAgainst(reference, pictured(scene, picture, pipeline("screen_space"),
                                                                   {"directions=hemisphere"})
                                                              .outputs.at("ambient_occlusion"))
                                  .rmse;
    CAPTURE(claim.scene, light, sphere, hemisphere);
    CHECK(light < (claim.light < 1.0 ? 1.0 : 1.1 * claim.light));
    CHECK(sphere < std::min(1.1 * claim.sphere, 1.0));
    CHECK(hemisphere < 1.1 * claim.hemisphere);
  }
}
