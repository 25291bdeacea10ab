// Committed scenes as near-field voxels see them: bits, what the camera sees, and the light in maps, on the
// device and on the host.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lumivox/measure/voxels.h"
#include "lumivox/toolkit/light_samples.h"
#include "support/passes.h"
#include "support/voxel_fragments.h"

namespace lumivox::test::near_field {

/// A scene as bits and as what its camera sees.
struct Seen {
  Scene scene;
  SceneSnapshot snapshot;
  BinaryGrid bits;
  GBuffer gbuffer;
  Seen(const std::string& name, int resolution, int side) : scene(committed(name)) {
    scene.cameras.front().width = scene.cameras.front().height = side;
    snapshot = snapshotOf(scene, 0.0);
    bits = bitsIn(scene, resolution);
    gbuffer = gbufferOf(scene);
  }
};

/// What the lights of a scene see, read back, and the radiance at a point by back-projection: one texel, both
/// tests, written anew in double precision.
class MapOnHost {
 public:
  explicit MapOnHost(const ReflectiveShadowMap& map)
      : lights_(map.lights->downloadValues<LightSampleData>()),
        views_(map.views->downloadValues<glm::mat4>()),
        position_(map.position->downloadFloats(0)),
        normal_(map.normal->downloadFloats(0)),
        flux_(map.flux->downloadFloats(0)),
        side_(map.position->description().width) {
    lights_.resize(static_cast<std::size_t>(map.lightCount));
  }

  glm::dvec3 radianceAt(const glm::dvec3& point, const glm::dvec3& toReceiver, double voxelSize) const {
    glm::dvec3 sum(0.0);
    for (const LightSampleData& light : lights_) sum += ofLight(light, point, toReceiver, voxelSize);
    return sum;
  }

 private:
  std::vector<LightSampleData> lights_;
  std::vector<glm::mat4> views_;
  std::vector<float> position_, normal_, flux_;
  int side_;

  static glm::dvec3 at(const std::vector<float>& texels, std::size_t texel) {
    return {texels[4 * texel], texels[4 * texel + 1], texels[4 * texel + 2]};
  }

  glm::dvec3 ofLight(const LightSampleData& light, const glm::dvec3& point, const glm::dvec3& toReceiver,
                     double voxelSize) const {
    const bool parallel = light.kind == LightSampleKind::directional;
    // The view that holds the point: the only one, or that of the six in which it is deepest.
    int layer = light.firstView;
    for (int face = 0; face < light.viewCount; ++face) {
      const glm::dvec4 clip =
          glm::dmat4(views_[static_cast<std::size_t>(light.firstView + face)]) * glm::dvec4(point, 1.0);
      if (clip.w > 0.0 && std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w)
        layer = light.firstView + face;
    }
    const glm::dvec4 clip = glm::dmat4(views_[static_cast<std::size_t>(layer)]) * glm::dvec4(point, 1.0);
    if (clip.w <= 0.0 || std::abs(clip.x) > clip.w || std::abs(clip.y) > clip.w) return glm::dvec3(0.0);
    const int x = std::min(static_cast<int>((0.5 + 0.5 * clip.x / clip.w) * side_), side_ - 1),
              y = std::min(static_cast<int>((0.5 - 0.5 * clip.y / clip.w) * side_), side_ - 1);
    const auto texel = static_cast<std::size_t>((layer * side_ + y) * side_ + x);
    const double area = normal_[4 * texel + 3];
    if (position_[4 * texel + 3] == 0.0f || area <= 0.0) return glm::dvec3(0.0);
    const glm::dvec3 place = at(position_, texel), normal = at(normal_, texel);
    if (glm::dot(normal, toReceiver) < 0.0) return glm::dvec3(0.0);
    const glm::dvec3 toLight =
        parallel ? -glm::dvec3(light.direction) : glm::normalize(glm::dvec3(light.position) - place);
    const double diagonal = std::sqrt(3.0) * voxelSize, width = light.texelWidth * (parallel ? 1.0 : clip.w),
                 allowed =
                     std::clamp(width / std::max(glm::dot(normal, toLight), 0.02), diagonal, 4.0 * diagonal);
    if (glm::distance(point, place) > allowed) return glm::dvec3(0.0);
    return at(flux_, texel) / (3.14159265358979323846 * area);
  }
};

}  // namespace lumivox::test::near_field
