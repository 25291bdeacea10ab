#include "lumivox/reference/depth.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lumivox/base/random.h"
#include "reference/ray_scene.h"

namespace lumivox {
namespace {

/// A normally distributed number of variance 1 (Box & Muller 1958).
double normal(RandomStream& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - static_cast<double>(random.uniform())));
  return radius * std::cos(2.0 * std::numbers::pi * static_cast<double>(random.uniform()));
}

double axialDeviation(double depth, double angle) {
  constexpr double kSteep = std::numbers::pi / 3.0;
  double deviation = 0.0012 + 0.0019 * (depth - 0.4) * (depth - 0.4);
  const double rest = 0.5 * std::numbers::pi - angle;
  if (angle > kSteep) deviation += 0.0001 / std::sqrt(depth) * angle * angle / (rest * rest);
  return deviation;
}

/// Standard deviation in pixels of an image of this width.
double lateralDeviation(double angle, int width) {
  constexpr double kColumns = 640.0;  // of the sensor
  return width / kColumns * (0.8 + 0.035 * angle / (0.5 * std::numbers::pi - angle));
}

/// The sensor quantises disparity, so steps of depth grow with the square of the distance.
double quantised(double depth) {
  constexpr double kStep = 0.00285;  // 1/m, of the inverse depth
  return 1.0 / (kStep * std::max(1.0, std::round(1.0 / (kStep * depth))));
}

}  // namespace

SeenDepths seenDepths(const Scene& scene, const SceneSnapshot& snapshot, double baseline) {
  const reference::RayScene rays(scene, snapshot);
  const CameraView& camera = snapshot.camera;
  SeenDepths seen;
  seen.width = camera.width;
  seen.height = camera.height;
  seen.focal = 0.5 * camera.height / static_cast<double>(camera.tanHalfFov);
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  seen.depth.assign(pixels, 0.0f);
  seen.angle.assign(pixels, 0.0f);
  seen.projected.assign(pixels, 0);
  const glm::vec3 projector = camera.eye - static_cast<float>(baseline) * camera.right;
  tbb::parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const glm::vec3 direction =
          camera.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      reference::Hit hit;
      const float length = glm::length(direction);
      if (!rays.closestHit(camera.eye, direction / length, hit)) continue;
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      seen.depth[at] = hit.distance / length;  // the direction's component along the view axis is 1
      reference::Surface surface;
      rays.surfaceAt(hit, direction / length, surface);
      const float cosine = std::abs(glm::dot(surface.geometricNormal, direction)) / length;
      seen.angle[at] = std::acos(std::min(cosine, 1.0f));
      const glm::vec3 path = projector - surface.position;
      constexpr float kBeforeProjector = 0.999f;
      seen.projected[at] = glm::dot(path, surface.geometricNormal) > 0.0f &&
                           !rays.occluded(surface.position, path, kBeforeProjector);
    }
  });
  return seen;
}

std::vector<float> kinectDepths(const SeenDepths& seen, std::uint64_t seed) {
  constexpr double kNearest = 0.5, kFarthest = 5.0;  // m
  constexpr double kSteepest = 80.0 / 180.0 * std::numbers::pi;
  std::vector<float> depths(seen.depth.size(), 0.0f);
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const auto index = [&](int column, int row) {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(seen.width) +
               static_cast<std::size_t>(column);
      };
      const std::size_t at = index(x, y);
      RandomStream random(seed, static_cast<std::uint32_t>(at));
      const double lateral = seen.depth[at] > 0.0f
                                 ? lateralDeviation(std::min<double>(seen.angle[at], kSteepest), seen.width)
                                 : 0.0;
      const double right = lateral * normal(random), down = lateral * normal(random), along = normal(random);
      const std::size_t from = index(std::clamp(x + static_cast<int>(std::lround(right)), 0, seen.width - 1),
                                     std::clamp(y + static_cast<int>(std::lround(down)), 0, seen.height - 1));
      const double depth = seen.depth[from], angle = seen.angle[from];
      if (!(depth > kNearest) || depth > kFarthest || angle > kSteepest || seen.projected[from] == 0)
        continue;
      const double measured = quantised(depth + along * axialDeviation(depth, angle));
      if (measured >= kNearest && measured <= kFarthest) depths[at] = static_cast<float>(measured);
    }
  }
  return depths;
}

}  // namespace lumivox
