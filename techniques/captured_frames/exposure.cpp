// How bright two frames are beside each other. Points that both see are compared, not whole pictures, so that
// a camera that turns to a darker wall counts as nothing. Surfaces are taken as Lambert's.
#include <algorithm>
#include <cmath>
#include <vector>

#include "passes.h"

namespace lumivox::captured_frames {
namespace {

/// The sum of a pixel's channels; 0 where it is not known, saturated, or so dark that its steps show.
double brightness(const CapturedImage& image, std::size_t pixel) {
  constexpr float kDarkest = 0.02f;  // of the file's range
  const float *colour = image.colour.data() + 3 * pixel, most = image.saturation;
  const float sum = colour[0] + colour[1] + colour[2];
  if (!std::isfinite(sum) || std::max({colour[0], colour[1], colour[2]}) >= most) return 0.0;
  return std::isfinite(most) && sum < 3.0f * kDarkest * most ? 0.0 : static_cast<double>(sum);
}

}  // namespace

std::optional<double> brightnessOver(const CaptureCamera& camera, const PosedImage& later,
                                     const PosedImage& earlier) {
  constexpr int kSamples = 24;         // along the shorter side
  constexpr double kSameDepth = 0.02;  // of the depth: both see one surface
  constexpr std::size_t kFewest = 24;  // points that say anything
  const auto indexOf = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
  };
  const glm::dquat toEarlier = glm::inverse(earlier.pose.rotation);
  const int step = std::max(1, std::min(camera.width, camera.height) / kSamples);
  std::vector<double> ratios;
  for (int y = step / 2; y < camera.height; y += step) {
    for (int x = step / 2; x < camera.width; x += step) {
      const std::size_t here = indexOf(x, y);
      const auto depth = static_cast<double>(later.image.depth[here]);
      const double bright = brightness(later.image, here);
      if (!(depth > 0.0) || !(bright > 0.0)) continue;
      const glm::dvec3 world = later.pose.rotation * (glm::dvec3(camera.ray({x, y}), 1.0) * depth) +
                               (later.pose.eye - earlier.pose.eye);
      const glm::dvec3 point = toEarlier * world;
      if (!(point.z > 0.0)) continue;
      const glm::dvec2 pixel = camera.project(glm::dvec2(point) / point.z) + 0.5;
      if (!(pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < camera.width && pixel.y < camera.height)) continue;
      const std::size_t there = indexOf(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
      const double before = brightness(earlier.image, there);
      const double apart = static_cast<double>(earlier.image.depth[there]) - point.z;
      if (before > 0.0 && std::abs(apart) <= kSameDepth * point.z) ratios.push_back(bright / before);
    }
  }
  if (ratios.size() < kFewest) return std::nullopt;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

}  // namespace lumivox::captured_frames
