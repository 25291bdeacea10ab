// Images and cameras at their limits. Two relations need no reference: the radiance along a ray does not
// depend on the camera; and the middle pixels of blocks of 3 x 3 see the rays of an image of a third of the
// size.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stress/case_tools.h"

namespace lumivox::stress {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// A ray is the same up to the last bits of single precision; look-ups of neighbours in the image may differ.
constexpr double kSameRay = 0.01;
/// Share of voxels that only this view makes and no triangle touches.
constexpr double kSpurious = 0.01;

/// For a voxelizer that starts from an image: the false voxels beyond those of an ordinary view.
Finding spuriousBeyond(Bench& bench, const Scene& ordinary, const Scene& scene, const Shot& shot) {
  const double usual = spuriousShare(bench, ordinary, {}), now = spuriousShare(bench, scene, shot);
  return judged("voxels that no triangle touches, beyond those of an ordinary view; of the occupied ones",
                {std::max(0.0, now - usual), 0.0}, kSpurious,
                fmt::format("{:.3g} of them are spurious, {:.3g} with an ordinary view", now, usual));
}

/// Compares an image with every third pixel of one of three times its size.
std::optional<Finding> everyThird(Bench& bench, int width, int height) {
  if (!seesCamera(bench)) return std::nullopt;
  const Scene scene = suitableScene(bench);
  Shot small, large;
  small.width = width, small.height = height;
  large.width = 3 * width, large.height = 3 * height;
  if (!makesImages(bench)) {
    const auto few = bench.voxelError(scene, small), many = bench.voxelError(scene, large);
    if (!few || !many) return std::nullopt;
    return judged("voxels found by a third of the rays along each side and lost by all; of the reference's",
                  {std::max(0.0, few->recall() - many->recall()), 0.0}, 0.0,
                  fmt::format("recall {:.3g}, and {:.3g} with all rays", few->recall(), many->recall()));
  }
  const ImageBuffer whole = bench.render(scene, large).compared, image = bench.render(scene, small).compared;
  ImageBuffer wanted(width, height, whole.channels());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int channel = 0; channel < whole.channels(); ++channel)
        wanted.at(x, y, channel) = whole.at(3 * x + 1, 3 * y + 1, channel);
  bench.show(image);
  return judged("RMSE against the same rays in an image of three times the size, of its mean",
                {relativeDifference(image, wanted), 0.0}, kSameRay);
}

/// A camera of one pixel along the ray through the middle of a pixel.
CameraView along(const CameraView& view, int x, int y) {
  CameraView one = view;
  one.forward = glm::normalize(view.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
  const glm::vec3 other = std::abs(one.forward.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  one.right = glm::normalize(glm::cross(one.forward, other));
  one.up = glm::cross(one.right, one.forward);
  one.width = one.height = 1;
  one.tanHalfFov = 0.01f;
  return one;
}

/// Compares pixels of an image with cameras that look along their rays only.
std::optional<Finding> raysAgree(Bench& bench, const Scene& scene, const Scene& ordinary) {
  if (!seesCamera(bench)) return std::nullopt;
  Shot shot;
  shot.width = shot.height = 33;
  if (!makesImages(bench)) return spuriousBeyond(bench, ordinary, scene, shot);
  constexpr int kPixels[][2] = {{16, 16}, {4, 6}, {27, 5}, {6, 28}, {29, 26}, {16, 2}, {2, 16}};
  constexpr std::size_t kCount = std::size(kPixels);
  const std::vector<Frame> frames = bench.renderSequence(scene, std::vector<double>(kCount + 1, 0.0), shot,
                                                         [&](std::size_t frame, SceneSnapshot& snapshot) {
                                                           if (frame == 0) return;
                                                           const auto [x, y] = kPixels[frame - 1];
                                                           snapshot.camera = along(snapshot.camera, x, y);
                                                         });
  const ImageBuffer& whole = frames.front().compared;
  const auto count = static_cast<int>(kCount);
  ImageBuffer seen(count, 1, whole.channels()), wanted(count, 1, whole.channels());
  for (int i = 0; i < count; ++i)
    for (int channel = 0; channel < whole.channels(); ++channel) {
      seen.at(i, 0, channel) = whole.at(kPixels[i][0], kPixels[i][1], channel);
      wanted.at(i, 0, channel) = frames[static_cast<std::size_t>(i) + 1].compared.at(0, 0, channel);
    }
  bench.show(whole);
  return judged(
      fmt::format("RMSE of {} pixels against cameras that look along their rays alone, of their mean", count),
      {relativeDifference(seen, wanted), 0.0}, kSameRay);
}

/// A point above what stands in the room, with walls in every direction but one.
glm::dvec3 insideOf(const Scene& scene) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  const glm::dvec3 share(0.47, 0.73, 0.41);  // not in the plane of any wall
  return snapshot.origin + glm::mix(glm::dvec3(snapshot.bounds.low), glm::dvec3(snapshot.bounds.high), share);
}

/// Looks from inside. From outside a whole room is smaller than a pixel of a view of 179 degrees, and smaller
/// than the steps in which a rasteriser places corners.
std::optional<Finding> atFov(Bench& bench, double fov) {
  const Scene ordinary = suitableScene(bench);
  Scene scene = ordinary;
  Camera& camera = scene.cameras.front();
  const glm::dvec3 ahead = camera.target - camera.eye;
  camera.eye = insideOf(scene);
  camera.target = camera.eye + ahead;
  camera.fov = fov;
  return raysAgree(bench, scene, ordinary);
}

/// The view turned so that it looks down, a thousandth of a degree off the plumb line.
std::optional<Finding> almostAlongUp(Bench& bench) {
  const Scene ordinary = suitableScene(bench);
  Scene scene = ordinary;
  Camera& camera = scene.cameras.front();
  camera.eye = insideOf(scene);
  camera.target = camera.eye - glm::dvec3(0.0, 1.0, 1e-3 * kDegree);
  camera.fov = 60.0 * kDegree;
  return raysAgree(bench, scene, ordinary);
}

/// A camera whose keys or only view is impossible. If the loader accepts it, no NaN may follow.
std::optional<Finding> impossible(Bench& bench, const std::string& camera, double time) {
  if (!seesCamera(bench)) return std::nullopt;
  const Scene scene =
      bench.sceneFromText("scene \"An impossible view\" {\n  camera main { " + camera +
                          "  fov 40 deg  resolution 16 16 }\n"
                          "  mesh room { file \"../models/cornell.obj\" }\n"
                          "  light lamp area { mesh room/ceiling_lamp  radiance 17 12 4 }\n}\n");
  Shot shot;
  shot.time = time;
  bench.render(scene, shot);
  return judged("images of a view that does not exist", {1.0, 0.0}, 0.0,
                "the view was accepted though it has no direction");
}

/// From a point of the floor upwards, and from a tenth of a millimetre above it.
std::optional<Finding> onSurface(Bench& bench) {
  if (!seesCamera(bench)) return std::nullopt;
  const Scene ordinary = suitableScene(bench);
  Scene scene = ordinary;
  Camera& camera = scene.cameras.front();
  constexpr double kLift = 1e-4;  // m
  // The floor of the room lies at height 0 in every scene of suitableScene().
  camera.eye = {camera.target.x, 0.0, camera.target.z};
  camera.target = camera.eye + glm::dvec3(0.05, 1.0, 0.1);
  camera.fov = 60.0 * kDegree;
  Scene lifted = scene;
  lifted.cameras.front().eye.y += kLift;
  lifted.cameras.front().target.y += kLift;
  if (!makesImages(bench)) return spuriousBeyond(bench, ordinary, scene, {});
  const ImageBuffer wanted = bench.render(lifted).compared, image = bench.render(scene).compared;
  bench.show(image);
  return judged("RMSE against the view from 0.1 mm above the surface, of its mean",
                {relativeDifference(image, wanted), 0.0}, 0.05);
}

std::optional<Finding> looksAway(Bench& bench) {
  if (!seesCamera(bench)) return std::nullopt;
  Scene scene = suitableScene(bench);
  scene.environment = glm::vec3(0.0f);
  scene.media.clear();
  Camera& camera = scene.cameras.front();
  camera.target = camera.eye + 10.0 * (camera.eye - camera.target);
  if (!makesImages(bench)) return spuriousBeyond(bench, suitableScene(bench), scene, {});
  const ImageBuffer image = bench.render(scene).whole;
  if (image.empty()) return withoutLight();
  const float largest = *std::max_element(image.values().begin(), image.values().end());
  return judged("largest radiance where nothing is", {largest, 0.0}, 0.0);
}

Case made(const char* name, const char* meaning, bool quick,
          std::function<std::optional<Finding>(Bench&)> run) {
  return {{"image_and_camera", name, meaning, quick}, std::move(run)};
}

}  // namespace

std::vector<Case> imageAndCameraCases() {
  const auto size = [](int width, int height) {
    return [=](Bench& bench) { return everyThird(bench, width, height); };
  };
  const auto view = [](const char* text, double time) {
    return [=](Bench& bench) { return impossible(bench, text, time); };
  };
  return {
      made("image_1x1", "one pixel: the ray of the middle of an image of 3 x 3", true, size(1, 1)),
      made("image_1x4096", "an image of 1 x 4096 pixels has the rays of every third of 3 x 12288", false,
           size(1, 4096)),
      made("image_4096x1", "an image of 4096 x 1 pixels has the rays of every third of 12288 x 3", false,
           size(4096, 1)),
      made("image_33x17", "an odd size: 33 x 17 pixels have the rays of every third of 99 x 51", true,
           size(33, 17)),
      made("fov_1_deg", "a view of 1 degree: its pixels are what cameras see that look along their rays",
           true, [](Bench& bench) { return atFov(bench, 1.0 * kDegree); }),
      made("fov_179_deg", "a view of 179 degrees: its pixels are what cameras see that look along their rays",
           true, [](Bench& bench) { return atFov(bench, 179.0 * kDegree); }),
      made(
          "view_almost_along_up",
          "a view a thousandth of a degree from `up`: its pixels are what cameras see that look along their rays",
          true, almostAlongUp),
      made("view_along_up", "`up` parallel to the view is refused", true,
           view("eye 0.278 0.5 0.28  target 0.278 0 0.28", 0.0)),
      made("eye_at_target", "eye and target in one point, so that no direction is ahead, are refused", true,
           view("eye 0.278 0.273 -0.8  target 0.278 0.273 -0.8", 0.0)),
      made("eye_passes_target", "a path on which the eye passes through the target is refused where it does",
           true,
           view("key { time 0  eye 0.278 0.273 -0.8  target 0.278 0.273 -0.4 }"
                "  key { time 1  eye 0.278 0.273 0  target 0.278 0.273 -0.4 }",
                0.5)),
      made("camera_on_surface", "the eye on the floor, exactly: the view from 0.1 mm above it", true,
           onSurface),
      made("camera_looks_away", "nothing but darkness in view: a black image", true, looksAway)};
}

}  // namespace lumivox::stress
