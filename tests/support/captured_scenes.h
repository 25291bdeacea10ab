// The committed mixed-reality scenes with pictures that a test makes in place of their files.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/reference/depth.h"
#include "support/against_reference.h"

namespace lumivox::test {

/// Images in memory.
class HeldFrames : public CaptureSource {
 public:
  explicit HeldFrames(std::vector<CapturedImage> images) : images_(std::move(images)) {}
  CapturedImage read(std::size_t frame) const override { return images_.at(frame); }

 private:
  std::vector<CapturedImage> images_;
};

/// A scene from where the depth camera stood at a frame.
inline Scene seenBy(const Capture& capture, const CaptureFrame& frame, Scene scene) {
  Camera camera;
  camera.name = "eye";
  camera.eye = frame.eye;
  camera.target = frame.eye + frame.rotation * glm::dvec3(0, 0, 1);
  camera.up = frame.rotation * glm::dvec3(0, -1, 0);
  camera.fov = 2.0 * std::atan(0.5 * capture.camera.height / capture.camera.focal.y);
  camera.width = capture.camera.width, camera.height = capture.camera.height;
  scene.cameras = {camera};
  return scene;
}

/// All bounces: a photograph holds them.
inline LayeredImage truthOf(const Scene& scene, const Picture& picture, double time = 0.0,
                            std::uint64_t seed = 1) {
  ReferenceOptions options = quietly(picture.referenceSamples);
  options.width = picture.width, options.height = picture.height;
  options.time = time;
  options.seed = seed;
  return renderReference(scene, options);
}

/// Exact depths and radiance of the real scene at each frame of the capture; its own random numbers each.
inline std::vector<CapturedImage> exactImages(const Capture& capture, int samples, std::uint64_t seed = 1) {
  std::vector<CapturedImage> images;
  for (const CaptureFrame& frame : capture.frames) {
    const Scene seen = seenBy(capture, frame, *capture.realScene);
    CapturedImage image;
    image.width = capture.camera.width, image.height = capture.camera.height;
    image.saturation = INFINITY;
    image.colour =
        truthOf(seen, {image.width, image.height, samples}, 0.0, seed++).layers.at("full").values();
    image.depth = seenDepths(seen, snapshotOf(seen, 0.0), 0.0).depth;
    images.push_back(std::move(image));
  }
  return images;
}

/// As a file of 8 bits holds the colours, with white at the radiance `exposure`.
inline CapturedImage inEightBits(CapturedImage image, float exposure) {
  for (float& value : image.colour) {
    const float encoded = linearToSrgb(std::clamp(value / exposure, 0.0f, 1.0f));
    value = exposure * srgbToLinear(std::round(255.0f * encoded) / 255.0f);
  }
  image.saturation = exposure;
  return image;
}

/// The scene with these images in place of the files of its capture, at these poses.
inline Scene withImages(Scene scene, std::vector<CapturedImage> images, std::vector<CaptureFrame> frames,
                        const CaptureCamera& camera) {
  const Capture& given = *scene.captures.at(0);
  auto capture = std::make_shared<Capture>(given.name, camera, std::move(frames),
                                           std::make_unique<HeldFrames>(std::move(images)));
  capture->realScene = given.realScene;
  static std::uint64_t number = 0;
  capture->hash = {2, ++number};
  scene.captures = {capture};
  return scene;
}
inline Scene withImages(const Scene& scene, std::vector<CapturedImage> images) {
  const Capture& given = *scene.captures.at(0);
  return withImages(scene, std::move(images), given.frames, given.camera);
}

}  // namespace lumivox::test
