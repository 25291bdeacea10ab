// The real scenes that committed captures stand for, seen from where their pictures were taken.
#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "lumivox/reference/depth.h"
#include "lumivox/reference/path_tracer.h"
#include "support/captures.h"

namespace lumivox::test {

/// What a capture stands for, with a camera in the place of one of its frames.
inline Scene realSceneOf(const Capture& capture, std::size_t frame = 0) {
  const CaptureFrame& taken = capture.frames.at(frame);
  Camera camera;
  camera.name = "eye";
  camera.eye = taken.eye;
  camera.target = taken.eye + taken.rotation * glm::dvec3(0, 0, 1);
  camera.up = taken.rotation * glm::dvec3(0, -1, 0);
  camera.fov = 2.0 * std::atan(0.5 * capture.camera.height / capture.camera.focal.y);
  camera.width = capture.camera.width, camera.height = capture.camera.height;
  Scene seen = *capture.realScene;
  seen.cameras = {camera};
  return seen;
}

/// Frames in memory.
class KeptFrames : public CaptureSource {
 public:
  explicit KeptFrames(std::vector<CapturedImage> images) : images_(std::move(images)) {}
  CapturedImage read(std::size_t frame) const override { return images_.at(frame); }

 private:
  std::vector<CapturedImage> images_;
};

/// The scene with exact depths and radiance in place of the files of its capture.
inline Scene withCleanFrames(const Scene& scene, int samples) {
  const Capture& given = *scene.captures.at(0);
  std::vector<CapturedImage> images;
  for (std::size_t frame = 0; frame < given.frames.size(); ++frame) {
    const Scene seen = realSceneOf(given, frame);
    ReferenceOptions options = quietly(samples);
    options.useCache = false;
    CapturedImage image;
    image.width = given.camera.width, image.height = given.camera.height;
    image.saturation = INFINITY;
    image.colour = renderReference(seen, options).layers.at("full").values();
    image.depth = seenDepths(seen, snapshotOf(seen, 0.0), 0.0).depth;
    images.push_back(std::move(image));
  }
  auto clean = std::make_shared<Capture>(given.name, given.camera, given.frames,
                                         std::make_unique<KeptFrames>(std::move(images)));
  clean->realScene = given.realScene;
  clean->hash = {2, static_cast<std::uint64_t>(samples)};
  Scene result = scene;
  result.captures = {clean};
  return result;
}

}  // namespace lumivox::test
