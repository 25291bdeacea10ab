// What captured frames survive and what they leave out: odd captures, odd places of virtual content, and
// frames in which nothing is to do.
#include <cmath>
#include <functional>

#include "support/captures.h"
#include "support/virtual_area_lights.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

const Settings kRaw{{"filter", 0}};
constexpr float kPicture = 1.0f;  // radiance of what plane() shows

/// Virtual content before the depth camera of a capture.
Scene withContent(const std::shared_ptr<const Capture>& capture,
                  const std::function<void(SceneBuilder&)>& add) {
  const Scene seen = sceneWith(capture);
  SceneBuilder builder;
  add(builder);
  builder.scene.cameras = seen.cameras;
  builder.scene.captures = seen.captures;
  return builder.scene;
}

/// A floor of 60 cm x 90 cm below the axis, from 1 m to 1.9 m, that a plane at 2 m lights.
void addFloor(SceneBuilder& builder, int material) {
  builder.quad({-0.3f, -0.3f, -1.0f}, {0.6f, 0, 0}, {0, 0, -0.9f}, material);
}
void addDullFloor(SceneBuilder& builder) {
  addFloor(builder, builder.lambert(0.5f));
}

RenderOptions few(const Pipeline& text, bool keepEverything = false) {
  RenderOptions options = sized(30, 20);
  options.parameters = text.settings({"lights=64", "points=100", "saturated=kept"});
  options.keepEverything = keepEverything;
  options.health = true;
  return options;
}

const Pipeline& captured() {
  static const Pipeline text = pipeline("captured_frames");
  return text;
}

/// A frame of the committed pipeline, of which every output of every pass is finite.
FrameResult healthy(const Scene& scene, RenderOptions options = few(captured()), double time = 0.0) {
  FrameResult frame = PipelineExecutor(device(), techniques(), scene, captured(), options).render(time);
  CAPTURE(frame.healthFindings);
  CHECK(frame.healthFindings.empty());
  return frame;
}

double lightIn(const FrameResult& frame) {
  return sumOf(frame.outputs.at("indirect_diffuse").values());
}

bool isAll(const ImageBuffer& image, float value) {
  return std::all_of(image.values().begin(), image.values().end(),
                     [&](float one) { return one == Approx(value).margin(1e-6); });
}

void requireSameBits(const FrameResult& one, const FrameResult& other) {
  REQUIRE(one.outputs.size() == other.outputs.size());
  for (const auto& [name, image] : one.outputs) {
    CAPTURE(name);
    CHECK(image.values() == other.outputs.at(name).values());
  }
}

/// Two frames, one second apart, of which the second is brighter.
Scene twoFrames(const std::function<void(SceneBuilder&)>& add) {
  return withContent(captureOf(smallCamera(), {plane(2.0), plane(2.0, 0.0, glm::vec3(1.2f))},
                               {frameAt(), frameAt(glm::dvec3(0), 1.0)}),
                     add);
}

}  // namespace

// ---- odd captures

TEST_CASE("the virtual floor of these tests is lit by the captured wall, and stands before it") {
  const FrameResult frame = healthy(withContent(captureOf(smallCamera(), {plane(2.0)}), addDullFloor));
  CHECK(lightIn(frame) > 1.0);
  CHECK(frame.outputs.at("final").at(15, 1, 0) == Approx(kPicture));
  CHECK(frame.outputs.at("final").at(15, 15, 0) < 0.9f * kPicture);
}

TEST_CASE("frames of holes alone and of one pixel show their picture, and light nothing") {
  const bool isOnePixel = GENERATE(false, true);
  CAPTURE(isOnePixel);
  const auto capture =
      isOnePixel ? captureOf(smallCamera(1, 1, 1.2), {plane(2.0)}) : captureOf(smallCamera(), {plane(0.0)});
  const FrameResult frame = healthy(withContent(capture, addDullFloor));
  CHECK(lightIn(frame) == 0.0);
  CHECK(frame.outputs.at("final").at(15, 1, 0) == Approx(kPicture));
}

TEST_CASE(
    "of a picture 16384 pixels wide every pixel becomes a light, and none is lost when some are chosen") {
  constexpr int kWide = 16384, kHigh = 2;
  constexpr double kFocal = 8000.0, kDistance = 2.0;
  const Scene scene = sceneWith(captureOf(smallCamera(kWide, kHigh, kFocal), {plane(kDistance)}));
  const CapturedMap map = lightsIn(scene, kRaw);
  const double expected = kPi * kDistance * kDistance * kWide * kHigh / (kFocal * kFocal);
  CHECK(map.flux() == Approx(expected).epsilon(0.01));
  const SurfaceLights chosen =
      LonePass("reflective_shadow_maps.choose", scene, {{"lights", 256}, {"order", "patches"}})
          .in("map", map.value)
          .out<SurfaceLights>("lights");
  constexpr std::size_t kWords = 12, kFlux = 8;  // of a light
  const std::vector<float> words = chosen.lights->downloadValues<float>();
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(chosen.count); ++i)
    sum += static_cast<double>(words[kWords * i + kFlux]);
  CHECK(sum == Approx(expected).epsilon(0.01));
}

TEST_CASE("exposures of a millionth and of a million scale the light, and nothing overflows") {
  const auto with = [](float exposure) {
    return withContent(captureOf(smallCamera(), {plane(2.0, 0.0, glm::vec3(exposure))}), addDullFloor);
  };
  const double flux = lightsIn(with(1.0f), kRaw).flux(), light = lightIn(healthy(with(1.0f)));
  REQUIRE(light > 0.0);
  for (const float exposure : {1e-6f, 1e6f}) {
    CAPTURE(exposure);
    const auto factor = static_cast<double>(exposure);
    CHECK(lightsIn(with(exposure), kRaw).flux() == Approx(factor * flux).epsilon(1e-5));
    CHECK(lightIn(healthy(with(exposure))) == Approx(factor * light).epsilon(1e-3));
  }
}

// ---- odd places

TEST_CASE("a depth camera whose surroundings touch it hides all virtual content") {
  const FrameResult frame = healthy(withContent(captureOf(smallCamera(), {plane(0.001)}), addDullFloor));
  CHECK(isAll(frame.outputs.at("final"), kPicture));
}

TEST_CASE(
    "a virtual wall through the eye, one behind it and one around the room leave the picture as it is") {
  const auto add = GENERATE(
      +[](SceneBuilder& builder) {  // the eye lies in the quad, which it sees from its edge
        builder.quad({-1, 0, -3}, {2, 0, 0}, {0, 0, 6}, builder.lambert(0.5f));
      },
      +[](SceneBuilder& builder) {  // behind the camera
        builder.quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, builder.lambert(0.5f));
      },
      +[](SceneBuilder& builder) {  // around the room that it sees
        builder.box({-5, -5, -5}, {5, 5, 5}, builder.lambert(0.5f), true);
      });
  const FrameResult frame = healthy(withContent(captureOf(smallCamera(), {plane(2.0)}), add));
  CHECK(isAll(frame.outputs.at("final"), kPicture));
}

TEST_CASE("virtual content around the depth camera hides the picture") {
  const Scene scene = withContent(captureOf(smallCamera(), {plane(2.0)}), [](SceneBuilder& builder) {
    builder.box({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, builder.lambert(0.0f), true);
  });
  CHECK(isAll(healthy(scene).outputs.at("final"), 0.0f));
}

TEST_CASE("lights a million metres from the world's origin lie where they do beside it") {
  const auto at = [](const glm::dvec3& place) {
    return withContent(captureOf(smallCamera(), {plane(2.0, 0.3)}, {frameAt(place)}),
                       [&](SceneBuilder& builder) {
                         addDullFloor(builder);
                         builder.scene.objects.back().placement = glm::translate(glm::dmat4(1.0), place);
                       });
  };
  const Scene near = at(glm::dvec3(0)), far = at({1e6, -1e6, 1e6});
  const CapturedMap beside = lightsIn(near, kRaw), away = lightsIn(far, kRaw);
  REQUIRE(beside.pixels.size() == away.pixels.size());
  for (std::size_t i = 0; i < beside.pixels.size(); ++i) {
    REQUIRE(glm::length(beside.pixels[i].position - away.pixels[i].position) < 1e-5f);
    REQUIRE(away.pixels[i].flux.x == Approx(beside.pixels[i].flux.x).epsilon(1e-4));
  }
  CHECK(lightIn(healthy(far)) == Approx(lightIn(healthy(near))).epsilon(1e-2));
}

TEST_CASE("virtual content a million metres from the frames is not lit by them, and nothing overflows") {
  const Scene scene =
      withContent(captureOf(smallCamera(), {plane(2.0)}, {frameAt({1e6, 0, 0})}), addDullFloor);
  const FrameResult frame = healthy(scene);
  CHECK(lightIn(frame) < 1e-6);
  CHECK(isAll(frame.outputs.at("final"), kPicture));
}

// ---- what is left out

TEST_CASE("without virtual content the picture is shown as it is, and no light is made") {
  const Scene scene = sceneWith(captureOf(smallCamera(), {plane(2.0)}));
  const FrameResult frame = healthy(scene);
  for (const char* pass : {"captured", "choose", "discs", "points", "gather", "occlude", "apply"}) {
    CAPTURE(pass);
    CHECK_FALSE(ran(frame, pass));
  }
  CHECK(ran(frame, "read"));
  CHECK(isAll(frame.outputs.at("final"), kPicture));
  requireSameBits(frame, healthy(scene, few(captured(), true)));
}

TEST_CASE("within one frame of the capture nothing is decoded or lit again, also where time runs backwards") {
  const Scene scene = twoFrames(addDullFloor);
  PipelineExecutor executor(device(), techniques(), scene, captured(), few(captured()));
  executor.render(1.0);
  const FrameResult later = executor.render(1.4);
  for (const char* pass : {"read", "captured", "choose", "gather", "apply", "composite"}) {
    CAPTURE(pass);
    CHECK_FALSE(ran(later, pass));
  }
  requireSameBits(later, healthy(scene, few(captured()), 1.4));
  requireSameBits(later, healthy(scene, few(captured(), true), 1.4));
  const FrameResult earlier = executor.render(0.9);
  CHECK(ran(earlier, "read"));
  requireSameBits(earlier, healthy(scene, few(captured()), 0.0));
  CHECK(lightIn(later) == Approx(1.2 * lightIn(earlier)).epsilon(1e-3));
}

TEST_CASE("without a glossy material no glossy light is gathered") {
  const bool isGlossy = GENERATE(false, true);
  CAPTURE(isGlossy);
  const Scene scene = withContent(captureOf(smallCamera(), {plane(2.0)}), [&](SceneBuilder& builder) {
    addFloor(builder, isGlossy ? builder.phong(0.3f, 0.5f, 20.0f) : builder.lambert(0.5f));
  });
  PipelineExecutor executor(device(), techniques(), scene, captured(), few(captured()));
  executor.keepOutput("gather", "light");
  const FrameResult frame = executor.render(0.0);
  CHECK((kept<SparseLight>(executor, "gather", "light").glossy != nullptr) == isGlossy);
  CHECK((sumOf(frame.outputs.at("indirect_glossy").values()) > 0.0) == isGlossy);
  requireSameBits(frame, healthy(scene, few(captured(), true)));
}
