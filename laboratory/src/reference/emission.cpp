#include "lumivox/reference/emission.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "reference/ray_scene.h"

namespace lumivox {

namespace {

/// Points of the lens relative to its centre, evenly distributed by area and angle; the centre alone for a
/// pinhole.
std::vector<glm::vec3> pointsOfLens(const CameraView& camera) {
  std::vector<glm::vec3> points{glm::vec3(0.0f)};
  if (!(camera.aperture > 0.0f)) return points;
  constexpr int kPoints = 32;
  constexpr float kGoldenAngle = 2.39996323f;
  for (int i = 0; i < kPoints; ++i) {
    const float radius = 0.5f * camera.aperture *
                         std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(kPoints)),
                angle = kGoldenAngle * static_cast<float>(i);
    points.push_back(radius * (std::cos(angle) * camera.right + std::sin(angle) * camera.up));
  }
  return points;
}

}  // namespace

std::vector<unsigned char> emittingPixels(const Scene& scene, const SceneSnapshot& snapshot) {
  const SceneTraits traits = SceneTraits::of(scene);
  if (!traits.emission && !traits.environment) return {};
  const reference::RayScene rays(scene, snapshot);
  const CameraView& camera = snapshot.camera;
  const auto width = static_cast<std::size_t>(camera.width);
  const auto height = static_cast<std::size_t>(camera.height);
  const std::vector<glm::vec3> lens = pointsOfLens(camera);
  std::vector<unsigned char> emits(width * height), lamps(width * height);
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const glm::vec3 direction =
          camera.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      std::size_t missed = 0;
      for (const glm::vec3& onLens : lens) {
        const glm::vec3 towards = camera.aperture > 0.0f ? glm::normalize(camera.focus * direction - onLens)
                                                         : glm::normalize(direction);
        reference::Hit hit;
        if (!rays.closestHit(camera.eye + onLens, towards, hit))
          missed += 1;
        else if (const reference::TriangleRecord& triangle = rays.triangles[hit.triangle];
                 rays.materials[triangle.material].emissive && glm::dot(triangle.normal, towards) < 0.0f)
          lamps[y * width + x] = 1;
      }
      if (traits.environment && 2 * missed >= lens.size()) emits[y * width + x] = 1;
    }
  });
  // A lamp outshines the other surfaces in a pixel of its silhouette.
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      if (lamps[y * width + x] == 0) continue;
      for (std::size_t v = y - std::min<std::size_t>(y, 1); v <= std::min(y + 1, height - 1); ++v)
        for (std::size_t u = x - std::min<std::size_t>(x, 1); u <= std::min(x + 1, width - 1); ++u)
          emits[v * width + u] = 1;
    }
  return emits;
}

}  // namespace lumivox
