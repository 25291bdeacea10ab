#include "lumivox/toolkit/environment.h"

#include <cmath>
#include <numbers>
#include <vector>

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
  std::array<glm::dvec3, 3> moments{};  // of red, green and blue: radiance times direction, over the sphere
  if (scene.environmentMap) {
    const EnvironmentMap& map = *scene.environmentMap;
    // Integrals over the azimuths of a column of sin and -cos, and over the polar angles of a row.
    std::vector<glm::dvec2> columns;
    const double turn = 2.0 * kPi / map.width;
    for (int column = 0; column < map.width; ++column) {
      const double left = turn * column - kPi, right = left + turn;
      columns.emplace_back(std::cos(left) - std::cos(right), std::sin(left) - std::sin(right));
    }
    const glm::vec3* texel = map.radiance.data();
    for (int row = 0; row < map.height; ++row) {
      const double a = kPi * row / map.height, b = kPi * (row + 1) / map.height;
      const double sideways = 0.5 * (b - a) - 0.25 * (std::sin(2.0 * b) - std::sin(2.0 * a)),
                   upwards = 0.5 * (std::sin(b) * std::sin(b) - std::sin(a) * std::sin(a)) * turn;
      for (int column = 0; column < map.width; ++column, ++texel) {
        const glm::dvec2& c = columns[static_cast<std::size_t>(column)];
        const glm::dvec3 direction(sideways * c.x, upwards, sideways * c.y);
        for (int channel = 0; channel < 3; ++channel)
          moments[static_cast<std::size_t>(channel)] += double((*texel)[channel]) * direction;
      }
    }
    for (glm::dvec3& moment : moments) moment = glm::transpose(glm::dmat3(map.toMap)) * moment;
  }
  std::array<glm::vec4, 3> bands;
  for (std::size_t c = 0; c < bands.size(); ++c)
    bands[c] = glm::vec4(4.0 * kPi * y0 * scene.environment[static_cast<int>(c)], y1 * moments[c].y,
                         y1 * moments[c].z, y1 * moments[c].x);
  return bands;
}

}  // namespace lumivox
