// Captures made by a test: depth and radiance as functions of the ray, in place of files.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "../../techniques/captured_frames/captured_frames_port.h"
#include "support/passes.h"

namespace lumivox::test {

/// What a depth camera sees along the ray (x, y, 1) of a pixel: depth, m (0: a hole), and radiance.
struct SeenPixel {
  double depth = 0.0;
  glm::vec3 radiance{1.0f};
};
using SeenAlong = std::function<SeenPixel(const glm::dvec2& ray)>;

class MadeFrames : public CaptureSource {
 public:
  MadeFrames(CaptureCamera camera, std::vector<SeenAlong> frames, float saturation)
      : camera_(camera), frames_(std::move(frames)), saturation_(saturation) {}
  CapturedImage read(std::size_t frame) const override {
    CapturedImage image;
    image.width = camera_.width, image.height = camera_.height;
    image.saturation = saturation_;
    for (int y = 0; y < camera_.height; ++y)
      for (int x = 0; x < camera_.width; ++x) {
        const SeenPixel seen = frames_.at(frame)(camera_.ray({x, y}));
        image.depth.push_back(static_cast<float>(seen.depth));
        for (int c = 0; c < 3; ++c) image.colour.push_back(seen.radiance[c]);
      }
    return image;
  }

 private:
  CaptureCamera camera_;
  std::vector<SeenAlong> frames_;
  float saturation_;
};

/// 60 x 40 pixels, focal length 50.
inline CaptureCamera smallCamera(int width = 60, int height = 40, double focal = 50.0) {
  CaptureCamera camera;
  camera.width = width, camera.height = height;
  camera.focal = glm::dvec2(focal);
  camera.centre = {0.5 * (width - 1), 0.5 * (height - 1)};
  return camera;
}

/// Looking along -z from (0, 0, 0) with y up, as scenes do: x right, y down, z forward of the capture.
inline CaptureFrame frameAt(const glm::dvec3& eye = glm::dvec3(0), double time = 0.0,
                            const glm::dquat& turned = glm::dquat(1, 0, 0, 0)) {
  return {time, glm::normalize(turned * glm::angleAxis(std::acos(-1.0), glm::dvec3(1, 0, 0))), eye};
}

inline std::shared_ptr<Capture> captureOf(const CaptureCamera& camera, std::vector<SeenAlong> seen,
                                          std::vector<CaptureFrame> frames = {frameAt()},
                                          float saturation = INFINITY) {
  auto capture = std::make_shared<Capture>("made", camera, std::move(frames),
                                           std::make_unique<MadeFrames>(camera, std::move(seen), saturation));
  static std::uint64_t number = 0;
  capture->hash = {1, ++number};
  return capture;
}

/// A scene with the capture, seen by a camera in its place. Without a virtual triangle the origin is the eye
/// of the first frame.
inline Scene sceneWith(std::shared_ptr<const Capture> capture) {
  SceneBuilder builder;
  Camera camera;
  camera.name = "ar";
  camera.capture = 0;
  camera.width = capture->camera.width, camera.height = capture->camera.height;
  builder.scene.cameras = {camera};
  builder.scene.captures = {std::move(capture)};
  return builder.scene;
}

/// A plane through (0, 0, distance) of the camera's space, with its normal turned away from the axis by
/// `slant` about y.
inline SeenAlong plane(double distance, double slant = 0.0, const glm::vec3& radiance = glm::vec3(1.0f)) {
  return [=](const glm::dvec2& ray) {
    // n (p - (0, 0, d)) = 0 with n = (sin, 0, -cos)
    const double z = distance * std::cos(slant) / (std::cos(slant) - std::sin(slant) * ray.x);
    return SeenPixel{z, radiance};
  };
}

inline captured_frames::CapturedFrames read(const Scene& scene, const Settings& settings = {},
                                            double time = 0.0) {
  return LonePass("captured_frames.read", scene, settings, time)
      .out<captured_frames::CapturedFrames>("frames");
}

/// A pixel of the map, as a light.
struct PixelLight {
  glm::vec3 position, normal, flux;
  float area = 0.0f;
  bool isSurface = false;
};

struct CapturedMap {
  ReflectiveShadowMap value;
  std::vector<PixelLight> pixels;  ///< layer by layer
  int width = 0;
  const PixelLight& at(int x, int y) const { return pixels.at(static_cast<std::size_t>(y * width + x)); }
  double flux() const {
    double sum = 0.0;
    for (const PixelLight& one : pixels) sum += static_cast<double>(one.flux.x);
    return sum;
  }
  double area() const {
    double sum = 0.0;
    for (const PixelLight& one : pixels) sum += static_cast<double>(one.area);
    return sum;
  }
};

inline CapturedMap lightsIn(const Scene& scene, const Settings& settings = {}, const Settings& reading = {},
                            double time = 0.0) {
  CapturedMap map;
  map.value = LonePass("captured_frames.lights", scene, settings, time)
                  .in("frames", read(scene, reading, time))
                  .out<ReflectiveShadowMap>("map");
  map.width = map.value.flux->description().width;
  const std::vector<float> position = map.value.position->downloadFloats(0),
                           normal = map.value.normal->downloadFloats(0),
                           flux = map.value.flux->downloadFloats(0);
  for (std::size_t i = 0; i < position.size(); i += 4)
    map.pixels.push_back({{position[i], position[i + 1], position[i + 2]},
                          {normal[i], normal[i + 1], normal[i + 2]},
                          {flux[i], flux[i + 1], flux[i + 2]},
                          normal[i + 3],
                          position[i + 3] > 0.0f});
  return map;
}

/// The real surfaces that the scene's camera sees, with depths as they are.
inline GBuffer surfacesIn(const Scene& scene) {
  const captured_frames::CapturedFrames frames = read(scene);
  const CapturedMap map = lightsIn(scene, {{"filter", 0}});
  return LonePass("captured_frames.surfaces", scene)
      .in("frames", frames)
      .in("map", map.value)
      .out<GBuffer>("gbuffer");
}

}  // namespace lumivox::test
