#include "lumivox/toolkit/environment.h"

#include <cmath>
#include <numbers>

#include "lumivox/pipeline/gpu_scene.h"
#include "lumivox/shader/slots.h"

namespace lumivox {
namespace {

/// Block EnvironmentView of common/environment_view.glsl.
struct alignas(16) EnvironmentViewBlock {
  glm::vec4 corner, perColumn, perRow, toMapX, toMapY, toMapZ;
};

}  // namespace

EnvironmentBinding::EnvironmentBinding(PassContext& frame) {
  add(shader::StorageSlot{"Environment"}(frame.scene().environmentLevels()));
}

int environmentMapOf(const PassContext& frame) {
  return frame.traits().environmentMap ? 1 : 0;
}

EnvironmentViewBinding::EnvironmentViewBinding(PassContext& frame) {
  const CameraView& camera = frame.snapshot().camera;
  const auto columns = static_cast<float>(camera.width), rows = static_cast<float>(camera.height);
  const glm::vec3 corner = camera.direction(0.0f, 0.0f);
  const auto& map = frame.sceneDescription().environmentMap;
  const glm::mat3 toMap = map ? map->toMap : glm::mat3(1.0f);
  add(shader::UniformSlot<EnvironmentViewBlock>{"EnvironmentView"}(
      {glm::vec4(corner, 0.0f), glm::vec4((camera.direction(columns, 0.0f) - corner) / columns, 0.0f),
       glm::vec4((camera.direction(0.0f, rows) - corner) / rows, 0.0f), glm::vec4(toMap[0], 0.0f),
       glm::vec4(toMap[1], 0.0f), glm::vec4(toMap[2], 0.0f)}));
  add(shader::SampledSlot{"environmentTexels"}(frame.scene().environmentTexels(), gpu::Sampling::nearest));
}

glm::vec3 brightestOfEnvironment(const Scene& scene) {
  return scene.environmentMap ? scene.environmentMap->brightest : scene.environment;
}

std::array<glm::vec4, 3> environmentBands(const Scene& scene) {
  constexpr double kPi = std::numbers::pi;
  const double y0 = 0.5 / std::sqrt(kPi), y1 = std::sqrt(3.0 / (4.0 * kPi));
  std::array<glm::dvec4, 3> sums{};
  if (!scene.environmentMap) {
    for (int c = 0; c < 3; ++c) sums[static_cast<std::size_t>(c)].x = 4.0 * kPi * y0 * scene.environment[c];
  } else {
    const EnvironmentMap& map = *scene.environmentMap;
    const glm::vec3* texel = map.radiance.data();
    for (int row = 0; row < map.height; ++row) {
      for (int column = 0; column < map.width; ++column, ++texel) {
        const glm::dvec3 d(map.direction(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f));
        const glm::dvec4 basis = map.solidAngle(row) * glm::dvec4(y0, y1 * d.y, y1 * d.z, y1 * d.x);
        for (int c = 0; c < 3; ++c) sums[static_cast<std::size_t>(c)] += double((*texel)[c]) * basis;
      }
    }
  }
  return {glm::vec4(sums[0]), glm::vec4(sums[1]), glm::vec4(sums[2])};
}

}  // namespace lumivox
