#include "scene/motion.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/scene/free_camera.h"

namespace lumivox {
namespace {

/// Gives valueAt() an optional member of a key.
template <class Key, class Value>
auto member(std::optional<Value> Key::*which) {
  return [which](const Key& key) -> const Value* { return key.*which ? &*(key.*which) : nullptr; };
}

glm::dvec3 turned(const glm::dmat4& motion, const glm::dvec3& direction) {
  return glm::dvec3(motion * glm::dvec4(direction, 0.0));
}

glm::dvec3 moved(const glm::dmat4& motion, const glm::dvec3& place) {
  return glm::dvec3(motion * glm::dvec4(place, 1.0));
}

}  // namespace

glm::dmat4 rigidMotionAt(const RigidMotion& motion, double time) {
  glm::dmat4 result = glm::translate(glm::dmat4(1.0), motion.pivot + motion.velocity * time);
  // Whole turns are left out first, so that late times lose no precision.
  const double angle = std::remainder(motion.angularSpeed * time, 2.0 * std::numbers::pi);
  result = glm::rotate(result, angle, motion.axis);
  return glm::translate(result, -motion.pivot);
}

Light lightAt(const Light& light, double time) {
  Light result = light;
  result.motion.reset();
  if (!light.motion) return result;
  const LightMotion& motion = *light.motion;
  const auto set = [&](auto& value, auto which) {
    value = valueAt(motion.keys, motion.interpolation, time, value, member(which));
  };
  set(result.position, &LightKey::position);
  set(result.direction, &LightKey::direction);
  set(result.power, &LightKey::power);
  set(result.innerAngle, &LightKey::innerAngle);
  set(result.outerAngle, &LightKey::outerAngle);
  // The text's check covers all times; keys made by code have none.
  if (!(glm::length(result.direction) >= kShortestMean))
    throw Error(fmt::format(
        "light '{}' turns between opposite directions at {} s; expected a key on the way between them",
        light.name, time));
  if (motion.rigid) {
    const glm::dmat4 rigid = rigidMotionAt(*motion.rigid, time);
    result.position = moved(rigid, result.position);
    result.direction = turned(rigid, result.direction);
  }
  return result;
}

Camera cameraAt(const Camera& camera, double time) {
  Camera result = camera;
  result.keys.clear();
  result.motion.reset();
  if (camera.capture >= 0) return result;
  const auto at = [&](const auto& own, const auto& valueOf) {
    return valueAt(camera.keys, camera.interpolation, time, own, valueOf);
  };
  result.eye = at(camera.eye, [](const CameraKey& key) { return &key.eye; });
  result.target = at(camera.target, [](const CameraKey& key) { return &key.target; });
  result.fov = at(camera.fov, member(&CameraKey::fov));
  if (camera.motion) {
    const glm::dmat4 rigid = rigidMotionAt(*camera.motion, time);
    result.eye = moved(rigid, result.eye);
    result.target = moved(rigid, result.target);
    result.up = turned(rigid, result.up);
  }
  return result;
}

}  // namespace lumivox
