// Neighbouring frames of different exposure: what captured_frames.read tells.
#include <cmath>

#include "lumivox/base/log.h"
#include "support/captures.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// What a frame sees of the wall z = -2, whose colour depends on the place.
SeenAlong wallFrom(const CaptureFrame& frame, double exposure,
                   const std::function<double(const glm::dvec3&)>& radiance) {
  return [=](const glm::dvec2& ray) {
    const glm::dvec3 direction = frame.rotation * glm::dvec3(ray, 1.0);
    const double depth = (-2.0 - frame.eye.z) / direction.z;
    return SeenPixel{depth,
                     glm::vec3(static_cast<float>(exposure * radiance(frame.eye + depth * direction)))};
  };
}

double even(const glm::dvec3&) {
  return 0.5;
}
/// Stripes 20 cm wide, brighter by a half at each metre to the right.
double striped(const glm::dvec3& place) {
  return std::exp(0.4 * place.x) * (std::fmod(std::abs(place.x), 0.4) < 0.2 ? 1.0 : 0.3);
}

/// The warnings of reading both frames at once.
std::string toldOf(const std::vector<SeenAlong>& seen, const std::vector<CaptureFrame>& frames,
                   float saturation = INFINITY) {
  const LogCapture log;
  read(sceneWith(captureOf(smallCamera(), seen, frames, saturation)), {{"frames", 2}}, 1.0);
  return log.text();
}

/// Frames from one place, the second brighter.
std::string toldOfStep(double step) {
  const std::vector<CaptureFrame> frames{frameAt(), frameAt(glm::dvec3(0), 1.0)};
  return toldOf({wallFrom(frames[0], 1.0, even), wallFrom(frames[1], step, even)}, frames);
}

}  // namespace

TEST_CASE(
    "frames that differ in exposure by more than a quarter are told, those that differ by less are not") {
  CHECK_THAT(toldOfStep(1.3), Catch::Contains("frame 1 of capture 'made' is 1.30 times as bright"));
  CHECK_THAT(toldOfStep(1.0 / 1.3), Catch::Contains("0.77 times as bright"));
  CHECK(toldOfStep(1.1).empty());
  CHECK(toldOfStep(1.0 / 1.1).empty());
  CHECK(toldOfStep(1.0).empty());
}

TEST_CASE("in a sequence each frame is compared with the one before, and told of once") {
  std::vector<CaptureFrame> frames;
  std::vector<SeenAlong> seen;
  for (int i = 0; i < 4; ++i) {
    frames.push_back(frameAt(glm::dvec3(0), i));
    seen.push_back(wallFrom(frames.back(), std::pow(1.5, i), even));
  }
  const Scene scene = sceneWith(captureOf(smallCamera(), seen, frames));
  const Pipeline text = Pipeline::parse(
      "pipeline \"p\" { pass read captured_frames.read { }\n pass gbuffer direct_lighting.gbuffer { }\n"
      "pass direct direct_lighting.shade { gbuffer gbuffer }\n"
      "pass compose direct_lighting.compose { direct direct.radiance }\n"
      "pass composite captured_frames.composite { gbuffer gbuffer virtual compose.radiance frames read.frames }\n"
      "output final composite.radiance }",
      "p.pipeline");
  PipelineExecutor executor(device(), techniques(), scene, text, {});
  const LogCapture log;
  executor.render(0.0);
  CHECK(log.text().empty());
  for (const double time : {1.0, 2.0, 3.0}) executor.render(time);
  const std::size_t first = log.text().find("frame 1 of capture 'made' is 1.50 times");
  REQUIRE(first != std::string::npos);
  CHECK(log.text().find("times as bright", first + 60) == std::string::npos);
}

TEST_CASE("a camera that moves along a wall of varied colours, or turns to it, is no change of exposure") {
  const bool turns = GENERATE(false, true);
  CAPTURE(turns);
  const CaptureFrame first = frameAt();
  const CaptureFrame second = turns ? frameAt(glm::dvec3(0), 1.0, glm::angleAxis(-0.35, glm::dvec3(0, 1, 0)))
                                    : frameAt({0.9, 0, 0}, 1.0);
  const auto meanOfPicture = [](const CaptureFrame& frame) {
    double sum = 0.0;
    for (double x = -0.6; x < 0.6; x += 0.01)
      sum += static_cast<double>(wallFrom(frame, 1.0, striped)({x, 0.0}).radiance.x);
    return sum;
  };
  REQUIRE(meanOfPicture(second) > 1.25 * meanOfPicture(first));  // whole pictures do differ
  CHECK(toldOf({wallFrom(first, 1.0, striped), wallFrom(second, 1.0, striped)}, {first, second}).empty());
  CHECK_THAT(toldOf({wallFrom(first, 1.0, striped), wallFrom(second, 1.4, striped)}, {first, second}),
             Catch::Contains("times as bright"));
}

TEST_CASE("colours that are saturated, not known or of another surface say nothing of the exposure") {
  const std::vector<CaptureFrame> frames{frameAt(), frameAt(glm::dvec3(0), 1.0)};
  const SeenAlong before = wallFrom(frames[0], 1.0, even);
  SECTION("saturated") {
    CHECK(toldOf({before, wallFrom(frames[1], 2.0, even)}, frames, 1.0f).empty());
  }
  SECTION("not known") {
    CHECK(toldOf({before, [](const glm::dvec2&) { return SeenPixel{2.0, glm::vec3(NAN)}; }}, frames).empty());
  }
  SECTION("without depth") {
    CHECK(toldOf({before,
                  [](const glm::dvec2&) {
                    return SeenPixel{0.0, glm::vec3(2.0f)};
                  }},
                 frames)
              .empty());
  }
  SECTION("a bright thing before most of the wall") {
    const auto after = [](const glm::dvec2& ray) {
      return ray.x < 0.3 ? SeenPixel{1.0, glm::vec3(2.0f)} : SeenPixel{2.0, glm::vec3(0.5f)};
    };
    CHECK(toldOf({before, after}, frames).empty());
  }
}
