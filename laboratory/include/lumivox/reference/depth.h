// What a depth camera would measure in a scene: depths along the view axis, with the noise of a real sensor.
#pragma once

#include <cstdint>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// Depths at the centres of pixels, row by row from the top.
struct SeenDepths {
  int width = 0, height = 0;
  double focal = 0.0;        ///< pixels
  std::vector<float> depth;  ///< m along the view axis; 0 where the ray meets nothing
  std::vector<float> angle;  ///< rad, between the surface's normal and the ray back to the camera
  std::vector<char>
      projected;  ///< whether a projector `baseline` to the left of the camera reaches the surface
};

SeenDepths seenDepths(const Scene& scene, const SceneSnapshot& snapshot, double baseline);

/// The depths that a Kinect would tell: axial noise 1.2 mm + 1.9 mm/m^2 (z - 0.4 m)^2, beyond 60 degrees of
/// slant also 0.1 mm / sqrt(z/m) a^2 / (pi/2 - a)^2, and lateral noise 0.8 + 0.035 a / (pi/2 - a) pixels
/// (Nguyen, Izadi & Lovell 2012); steps of 2.85 mm/m^2 z^2 (Khoshelham & Elberink 2012); holes
/// beyond 80 degrees, where the projector does not reach, below 0.5 m and beyond 5 m. The same seed gives the
/// same noise.
std::vector<float> kinectDepths(const SeenDepths& seen, std::uint64_t seed);

/// Distance of the Kinect's projector from its camera, m (Khoshelham & Elberink 2012).
inline constexpr double kKinectBaseline = 0.075;

}  // namespace lumivox
