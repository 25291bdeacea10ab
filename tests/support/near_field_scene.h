// Committed scenes as inputs of near-field voxels: bits, g-buffer and reflective shadow maps, on the device
// and on the host.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/measure/voxels.h"
#include "lumivox/toolkit/light_samples.h"
#include "support/passes.h"
#include "support/voxel_fragments.h"

namespace lumivox::test::near_field {

/// A scene with its bits and its camera's g-buffer.
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

/// A reflective shadow map read back, with the radiance at a point by back-projection: one texel, both tests,
/// implemented again in double precision.
class MapOnHost {
 public:
  explicit MapOnHost(const ReflectiveShadowMap& map)
      : lights_(map.lights->downloadValues<LightSampleData>()),
        views_(map.views->downloadValues<glm::mat4>()),
        position_(map.position->downloadFloats(0)),
        normal_(map.normal->downloadFloats(0)),
        flux_(map.flux->downloadFloats(0)),
        albedo_(map.albedo ? map.albedo->downloadFloats(0) : std::vector<float>()),
        side_(map.position->description().width) {
    lights_.resize(static_cast<std::size_t>(map.lightCount));
  }

  glm::dvec3 radianceAt(const glm::dvec3& point, const glm::dvec3& toReceiver, double voxelSize) const {
    glm::dvec3 sum(0.0);
    for (const LightSampleData& light : lights_)
      if (const auto texel = showing(light, point, toReceiver, voxelSize))
        sum += at(flux_, *texel) / (3.14159265358979323846 * normal_[4 * *texel + 3]);
    return sum;
  }
  /// The surface in the map of the first light that lights the point; nothing in shadow.
  struct Surface {
    glm::dvec3 normal, albedo;
  };
  std::optional<Surface> surfaceAt(const glm::dvec3& point, const glm::dvec3& toReceiver,
                                   double voxelSize) const {
    for (const LightSampleData& light : lights_)
      if (const auto texel = showing(light, point, toReceiver, voxelSize))
        return Surface{at(normal_, *texel), at(albedo_, *texel)};
    return std::nullopt;
  }

 private:
  std::vector<LightSampleData> lights_;
  std::vector<glm::mat4> views_;
  std::vector<float> position_, normal_, flux_, albedo_;
  int side_;

  static glm::dvec3 at(const std::vector<float>& texels, std::size_t texel) {
    return {texels[4 * texel], texels[4 * texel + 1], texels[4 * texel + 2]};
  }

  /// The texel in which a light sees the point.
  std::optional<std::size_t> showing(const LightSampleData& light, const glm::dvec3& point,
                                     const glm::dvec3& toReceiver, double voxelSize) const {
    const bool parallel = light.kind == LightSampleKind::directional;
    // The view that contains the point: the only one, or one of six.
    int layer = light.firstView;
    for (int face = 0; face < light.viewCount; ++face) {
      const glm::dvec4 clip =
          glm::dmat4(views_[static_cast<std::size_t>(light.firstView + face)]) * glm::dvec4(point, 1.0);
      if (clip.w > 0.0 && std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w)
        layer = light.firstView + face;
    }
    const glm::dvec4 clip = glm::dmat4(views_[static_cast<std::size_t>(layer)]) * glm::dvec4(point, 1.0);
    if (clip.w <= 0.0 || std::abs(clip.x) > clip.w || std::abs(clip.y) > clip.w) return std::nullopt;
    const int x = std::min(static_cast<int>((0.5 + 0.5 * clip.x / clip.w) * side_), side_ - 1),
              y = std::min(static_cast<int>((0.5 - 0.5 * clip.y / clip.w) * side_), side_ - 1);
    const auto texel = static_cast<std::size_t>((layer * side_ + y) * side_ + x);
    const double area = normal_[4 * texel + 3];
    if (position_[4 * texel + 3] == 0.0f || area <= 0.0) return std::nullopt;
    const glm::dvec3 place = at(position_, texel), normal = at(normal_, texel);
    if (glm::dot(normal, toReceiver) < 0.0) return std::nullopt;
    const glm::dvec3 toLight =
        parallel ? -glm::dvec3(light.direction) : glm::normalize(glm::dvec3(light.position) - place);
    const double diagonal = std::sqrt(3.0) * voxelSize, width = light.texelWidth * (parallel ? 1.0 : clip.w),
                 allowed =
                     std::clamp(width / std::max(glm::dot(normal, toLight), 0.02), diagonal, 4.0 * diagonal);
    if (glm::distance(point, place) > allowed) return std::nullopt;
    return texel;
  }
};

}  // namespace lumivox::test::near_field
