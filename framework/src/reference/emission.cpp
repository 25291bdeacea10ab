#include "lumivox/reference/emission.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "reference/ray_scene.h"

namespace lumivox {

std::vector<unsigned char> emittingPixels(const Scene& scene, const SceneSnapshot& snapshot) {
  const SceneTraits traits = SceneTraits::of(scene);
  if (!traits.emission && !traits.environment) return {};
  const reference::RayScene rays(scene, snapshot);
  const CameraView& camera = snapshot.camera;
  const auto width = static_cast<std::size_t>(camera.width);
  const auto height = static_cast<std::size_t>(camera.height);
  std::vector<unsigned char> emits(width * height), lamps(width * height);
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const glm::vec3 direction =
          glm::normalize(camera.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
      reference::Hit hit;
      if (!rays.closestHit(camera.eye, direction, hit))
        emits[y * width + x] = traits.environment ? 1 : 0;
      else if (const reference::TriangleRecord& triangle = rays.triangles[hit.triangle];
               rays.materials[triangle.material].emissive && glm::dot(triangle.normal, direction) < 0.0f)
        lamps[y * width + x] = 1;
    }
  });
  // A lamp outshines what it shares a pixel of its silhouette with.
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
