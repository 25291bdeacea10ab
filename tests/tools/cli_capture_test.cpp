// lumivox capture: what it writes is read back as a capture of the same surfaces; the committed captures are
// its work.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lumivox/base/image.h"
#include "lumivox/reference/depth.h"
#include "lumivox/scene/scene.h"
#include "lumivox/scene/text.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

/// A lit wall at 2 m that fills the view, and a camera that moves towards it by 0.5 m/s.
constexpr const char* kWall =
    "scene \"Wall\" {\n  camera main {\n    resolution 16 12\n    fov 60 deg\n"
    "    key { time 0 s  eye 0 0 2  target 0 0 0 }\n    key { time 1 s  eye 0 0 1.5  target 0 0 0 }\n  }\n"
    "  material grey { diffuse 0.5 }\n"
    "  mesh wall { file \"wall.obj\"  material grey }\n  light sun directional { direction 0 0 -1  irradiance 3 }\n}\n";
constexpr const char* kObj = "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3\nf 1 3 4\n";

/// The scene that the printed block makes, with the capture in it.
Scene readBack(const Workplace& place, std::string block) {
  return loadSceneText("scene \"back\" {\n camera main { capture shots }\n " + block + " }",
                       place / "wall.scene");
}

struct WallPlace : Workplace {
  WallPlace() {
    write("wall.scene", kWall);
    write("wall.obj", kObj);
  }
};

}  // namespace

TEST_CASE("a capture that is written is read back with its depths, radiance, poses and times") {
  const bool exr = GENERATE(false, true);
  CAPTURE(exr);
  const WallPlace place;
  const CommandResult result = typed("-q capture", place / "wall.scene", "--frames 0..1 --fps 1 --spp 4 -o",
                                     place / "shots", exr ? "--exr" : "--exposure 1");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  const Scene scene = readBack(place, result.output);
  REQUIRE(scene.captures.size() == 1);
  const Capture& capture = *scene.captures.front();
  REQUIRE(capture.frames.size() == 2);
  CHECK(capture.frames[1].time == Approx(1.0));
  CHECK(glm::length(capture.frames[0].eye - glm::dvec3(0, 0, 2)) < 1e-6);
  CHECK(glm::length(capture.frames[1].eye - glm::dvec3(0, 0, 1.5)) < 1e-6);
  CHECK(glm::length(capture.frames[0].rotation * glm::dvec3(0, 0, 1) - glm::dvec3(0, 0, -1)) < 1e-6);
  CHECK(capture.camera.focal.y == Approx(6.0 / std::tan(M_PI / 6.0)));
  const double half = exr ? 1e-5 : 0.5 / 5000.0 + 1e-6;
  for (const float depth : capture.image(0)->depth) REQUIRE(std::abs(depth - 2.0) <= half);
  for (const float depth : capture.image(1)->depth) REQUIRE(std::abs(depth - 1.5) <= half);
  // Albedo 0.5 under 3 W/m^2: radiance 1.5 / pi, in 8 bits to half a step.
  for (const float radiance : capture.image(0)->colour)
    REQUIRE(radiance == Approx(1.5 / M_PI).epsilon(exr ? 1e-4 : 0.01));
  REQUIRE(capture.realScene != nullptr);
  CHECK(capture.realScene->name == "Wall");
}

TEST_CASE("the noise of depths has the sensor's deviation and holes, and the same bits for a seed") {
  const WallPlace place;
  const Scene scene = loadScene(place / "wall.scene");
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0, {}, 160, 120);
  const SeenDepths seen = seenDepths(scene, snapshot, kKinectBaseline);
  const std::vector<float> noisy = kinectDepths(seen, 5);
  CHECK(noisy == kinectDepths(seen, 5));
  CHECK(noisy != kinectDepths(seen, 6));
  double squares = 0.0, sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    if (seen.angle[i] > 0.5f) continue;
    REQUIRE(noisy[i] > 0.0f);
    const double error = static_cast<double>(noisy[i]) - static_cast<double>(seen.depth[i]);
    sum += error;
    squares += error * error;
    ++count;
  }
  // 1.2 mm + 1.9 mm/m^2 (2 m - 0.4 m)^2, and steps of 2.85 mm/m^2 (2 m)^2, which spread evenly over their
  // width.
  const double axial = 0.0012 + 0.0019 * 1.6 * 1.6, step = 0.00285 * 4.0;
  CHECK(std::sqrt(squares / count) == Approx(std::hypot(axial, step / std::sqrt(12.0))).epsilon(0.1));
  CHECK(std::abs(sum / count) < 0.001);
  // At 0.4 m the sensor sees nothing.
  Scene near = scene;
  near.cameras.front().keys.clear();
  near.cameras.front().eye = {0, 0, 0.4};
  near.cameras.front().target = glm::dvec3(0);
  for (const float depth :
       kinectDepths(seenDepths(near, snapshotOf(near, 0.0, {}, 16, 12), kKinectBaseline), 1))
    REQUIRE(depth == 0.0f);
}

TEST_CASE("behind an edge the projector leaves a shadow without depth") {
  const Workplace place;
  place.write(
      "edge.obj",
      "v 0 -9 1\nv 9 -9 1\nv 9 9 1\nv 0 9 1\nf 1 2 3\nf 1 3 4\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 5 6 7\nf 5 7 8\n");
  const Scene scene = loadSceneText(
      "scene \"s\" { camera main { eye 0 0 2 target 0 0 0 } material grey { diffuse 0.5 } mesh edge { file \"edge.obj\" "
      "material grey } }",
      place / "edge.scene");
  constexpr int kSide = 300, kMiddle = kSide / 2;
  const SeenDepths seen = seenDepths(scene, snapshotOf(scene, 0.0, {}, kSide, kSide), kKinectBaseline);
  // The plate at 1 m begins at the middle of the view. A ray from 7.5 cm to the left passes its edge towards
  // the right: what the camera sees of the wall to the left of it is lit.
  const auto shadowOf = [&](const SeenDepths& depths) {
    const auto row = depths.projected.begin() + kMiddle * kSide;
    return std::count(row, row + kMiddle - 1, 0);
  };
  CHECK(shadowOf(seen) == 0);
  // From the right of the edge the plate hides the wall beside it from a projector on the other side.
  const SeenDepths other = seenDepths(scene, snapshotOf(scene, 0.0, {}, kSide, kSide), -kKinectBaseline);
  // The shadow is as wide on the wall as the baseline.
  const double pixel = 2.0 * std::tan(20.0 * M_PI / 180.0) * 2.0 / kSide;
  CHECK(static_cast<double>(shadowOf(other)) * pixel == Approx(kKinectBaseline).margin(1.5 * pixel));
}

TEST_CASE("bad input of capture is refused before anything is written") {
  const WallPlace place;
  checkRefused(typed("capture", place / "wall.scene", "--noise snow -o", place / "a"), "kinect");
  checkRefused(typed("capture", place / "wall.scene", "--frames 3..1 -o", place / "a"), "--frames");
  checkRefused(typed("capture", place / "none.scene", "-o", place / "a"), "none.scene");
  checkRefused(typed("capture", place / "wall.scene", "--camera side -o", place / "a"), "side");
  CHECK_FALSE(fs::exists(place / "a"));
}

TEST_CASE("the committed captures are what the command makes of their scene") {
  const Workplace place;
  const auto [folder, options] = GENERATE(table<std::string, const char*>(
      {{"cornell_past", "--camera past --noise kinect"}, {"cornell_three", "--camera three"}}));
  CAPTURE(folder);
  const fs::path committed = sourceDirectory() / "scenes/captures" / folder;
  const CommandResult made = typed("-q capture", sourceDirectory() / "scenes/captures/cornell_cameras.scene",
                                   options, "--fps 10 --spp 256 -o", place / "made");
  INFO(made.errors);
  REQUIRE(made.exitCode == 0);
  const auto depthsOf = [](const fs::path& file) { return decodeGreyPng16(readFile(file), file).values; };
  const std::vector<std::uint16_t> depths = depthsOf(place / "made/depth/0000.png"),
                                   kept = depthsOf(committed / "depth/0000.png");
  REQUIRE(depths.size() == kept.size());
  std::size_t others = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) others += std::abs(depths[i] - kept[i]) > 1;
  CHECK(others <= depths.size() / 100);
  const ByteImage colours = readByteImage(place / "made/rgb/0000.png"),
                  keptColours = readByteImage(committed / "rgb/0000.png");
  REQUIRE(colours.values.size() == keptColours.values.size());
  double squares = 0.0, all = 0.0;
  for (std::size_t i = 0; i < colours.values.size(); ++i) {
    squares += std::pow(static_cast<double>(colours.values[i]) - keptColours.values[i], 2.0);
    all += std::pow(static_cast<double>(keptColours.values[i]), 2.0);
  }
  CHECK(std::sqrt(squares / all) < 0.01);
}

TEST_CASE(
    "a report of captured light without a scene that stands for it has times, no errors, and says why") {
  const bool stands = GENERATE(true, false);
  CAPTURE(stands);
  const WallPlace place;
  const CommandResult made =
      typed("-q capture", place / "wall.scene", "--spp 4 --exposure 1 -o", place / "shots");
  REQUIRE(made.exitCode == 0);
  std::string block = made.output;
  const std::size_t at = block.find("stands_for");
  REQUIRE(at != std::string::npos);
  if (!stands) block.erase(at, block.find('\n', at) - at);
  place.write("plate.obj",
              "v -0.3 -0.3 0.5\nv 0.3 -0.3 0.5\nv 0.3 0.3 0.5\nv -0.3 0.3 0.5\nf 1 2 3\nf 1 3 4\n");
  place.write("back.scene",
              "scene \"back\" {\n  camera main { capture shots }\n" + block +
                  "  material grey { diffuse 0.5 }\n  mesh plate { file \"plate.obj\"  material grey }\n}\n");
  const CommandResult result = typed("report", place / "back.scene", "--pipeline",
                                     sourceDirectory() / "scenes/pipelines/captured_frames.pipeline",
                                     "--quick --no-sweep --spp 4 -o", place / "page.html");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  CHECK((result.errors.find("stands_for") == std::string::npos) == stands);
  const std::string json = readFile(place / "page.json");
  CHECK((json.find("\"rmse\"") != std::string::npos) == stands);
  CHECK(json.find("frame_ms") != std::string::npos);
}
