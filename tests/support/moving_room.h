// A room with moving objects under one light, for runs of pipelines.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "support/scene_builder.h"
#include "support/techniques.h"

namespace lumivox::test {

/// A room in which a box turns and a plate travels between the lights and the floor.
inline Scene movingRoom(const std::function<void(SceneBuilder&)>& light) {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.box({-1, -1, -1}, {1, 1, 1}, grey, false);
  builder.box({-0.8f, -1.0f, -0.6f}, {-0.4f, -0.3f, -0.2f}, grey, false);
  const std::size_t first = builder.scene.objects.size();
  builder.box({0.3f, -0.6f, 0.3f}, {0.5f, -0.4f, 0.5f}, grey, false);
  for (std::size_t o = first; o < builder.scene.objects.size(); ++o)
    builder.scene.objects[o].motion = RigidMotion{{0, 1, 0.2}, 0.7, {0.4, -0.5, 0.4}, {0, 0, 0}};
  builder.quad({-0.6f, 0.2f, 0.1f}, {0.3f, 0, 0}, {0, 0.1f, 0.3f}, grey).motion =
      RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, {0.1, 0, 0.05}};
  light(builder);
  builder.look({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  return builder.scene;
}

inline const glm::vec3 kSun = glm::normalize(glm::vec3(0.3f, -1.0f, 0.2f));

inline void sun(SceneBuilder& builder) {
  // Removes the ceiling.
  std::erase_if(builder.scene.objects, [&](const Object& object) {
    const auto first = builder.scene.positions.begin() + object.firstVertex;
    return std::all_of(first, first + object.vertexCount, [](const glm::vec3& at) { return at.y > 0.99f; });
  });
  builder.light(LightKind::directional, glm::vec3(3.0f), {0, 0, 0}, kSun);
}
inline void lamp(SceneBuilder& builder) {
  builder.light(LightKind::point, glm::vec3(1.0f), {0.1f, 0.8f, 0.0f}, {0, -1, 0});
}
inline void spot(SceneBuilder& builder) {
  builder.light(LightKind::spot, glm::vec3(1.0f), {-0.7f, 0.8f, 0.3f}, {0.5f, -1, 0});
}
inline void area(SceneBuilder& builder) {
  builder.quad({-0.2f, 0.95f, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, builder.lambert(0.5f, 5.0f));
}

struct RoomLight {
  const char* name;
  void (*light)(SceneBuilder&);
};
inline constexpr std::array kRoomLights{RoomLight{"sun", sun}, RoomLight{"lamp", lamp},
                                        RoomLight{"spot", spot}, RoomLight{"area", area}};

/// Whether the pass reused results for static geometry in the last frame.
inline bool reusesStill(const PipelineExecutor& executor, const std::string& pass) {
  const std::vector<LeftOut> leftOut = executor.explain().leftOut;
  return std::any_of(leftOut.begin(), leftOut.end(), [&](const LeftOut& one) {
    return one.level == LeftOut::Level::time && one.pass == pass &&
           one.what.find("static geometry") != std::string::npos;
  });
}

}  // namespace lumivox::test
