#include "lumivox/reference/emission.h"

#include <tbb/parallel_for.h>

#include "reference/ray_scene.h"

namespace lumivox {

std::vector<unsigned char> emittingPixels(const Scene& scene, const SceneSnapshot& snapshot) {
  const SceneTraits traits = SceneTraits::of(scene);
  if (!traits.emission && !traits.environment) return {};
  const reference::RayScene rays(scene, snapshot);
  const CameraView& camera = snapshot.camera;
  const auto width = static_cast<std::size_t>(camera.width);
  std::vector<unsigned char> emits(width * static_cast<std::size_t>(camera.height));
  tbb::parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const glm::vec3 direction =
          glm::normalize(camera.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
      reference::Hit hit;
      const bool shines =
          rays.closestHit(camera.eye, direction, hit)
              ? rays.emissionTowards(rays.triangles[hit.triangle], direction) != glm::vec3(0.0f)
              : traits.environment;
      emits[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] = shines ? 1 : 0;
    }
  });
  return emits;
}

}  // namespace lumivox
