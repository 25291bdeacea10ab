// Captures: pictures and depths that a depth camera took of a real scene, with the camera's pose at each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/base/hash.h"

namespace lumivox {

struct Scene;

/// The pinhole of a capture in OpenCV's convention: the centre of the upper left pixel has the coordinates
/// (0, 0), x runs right, y down and z forward. A ray is (x, y, 1), and depth is measured along z, not along
/// the ray.
struct CaptureCamera {
  int width = 0, height = 0;           ///< of the depth image
  glm::dvec2 focal{0}, centre{0};      ///< pixels; both focal lengths are above 0
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3 of OpenCV's radial and tangential model

  bool distorted() const;
  /// The pixel coordinates at which the ray (x, y, 1) arrives.
  glm::dvec2 project(const glm::dvec2& ray) const;
  /// The ray (x, y, 1) through pixel coordinates: the inverse of project(). NaN where the distortion has no
  /// inverse within 10^-9.
  glm::dvec2 ray(const glm::dvec2& pixel) const;
  bool operator==(const CaptureCamera&) const = default;
};

/// The pose and the time of one frame.
struct CaptureFrame {
  double time = 0.0;                ///< s of the scene: the first frame has 0
  glm::dquat rotation{1, 0, 0, 0};  ///< camera (x right, y down, z forward) to world; unit length
  glm::dvec3 eye{0};                ///< m, world
};

/// One frame's pixels, row by row from the top, in the camera's size.
struct CapturedImage {
  int width = 0, height = 0;
  std::vector<float> colour;  ///< three a pixel: linear radiance, W/(sr m^2); NaN where none is known
  std::vector<float> depth;   ///< m along z; 0 in holes
  /// The radiance at which the file's colours end, W/(sr m^2): a channel that reaches it is saturated.
  float saturation = 0.0f;  ///< infinity for files of floats
};

/// The files of a capture. One class for each format.
class CaptureSource {
 public:
  virtual ~CaptureSource() = default;
  /// Decodes a frame. Error names the file or the frame. May be called from several threads.
  virtual CapturedImage read(std::size_t frame) const = 0;
};

class Capture {
 public:
  std::string name;
  CaptureCamera camera;
  std::vector<CaptureFrame> frames;  ///< at least one, in the order of their times
  std::shared_ptr<const Scene>
      realScene;     ///< what the capture stands for, for the reference alone; may be null
  ContentHash hash;  ///< of the text's block, the texts of the capture and its frames

  Capture(std::string name, CaptureCamera camera, std::vector<CaptureFrame> frames,
          std::unique_ptr<const CaptureSource> source);
  ~Capture();

  /// The last frame that is not after `time`; the first before all.
  std::size_t frameAt(double time) const;
  /// The decoded frame. The last few are kept. Error as CaptureSource::read(), also for a frame of another
  /// size than the first.
  std::shared_ptr<const CapturedImage> image(std::size_t frame) const;

 private:
  struct Cache;
  std::unique_ptr<const CaptureSource> source_;
  std::unique_ptr<Cache> cache_;
};

/// A capture at one time, relative to SceneSnapshot::origin.
struct CaptureState {
  std::size_t frame = 0;
  glm::vec3 eye{0.0f};
  glm::mat3 toWorld{1.0f};  ///< columns: right, down and forward
  bool operator==(const CaptureState&) const = default;
};

/// The pose of a frame relative to an origin: the subtraction happens in double precision.
CaptureState captureStateOf(const Capture& capture, std::size_t frame, const glm::dvec3& origin);

}  // namespace lumivox
