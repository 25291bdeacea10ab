#include "lumivox/toolkit/visible_surface.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace lumivox {

namespace {

// Blocks of common/visible_surface.glsl.
struct alignas(16) ViewBlock {
  glm::mat4 worldToClip;
};
struct alignas(16) EyeBlock {
  glm::vec3 eyeWorld;
  float padding = 0.0f;
  glm::vec2 imageSize;
};
struct alignas(16) DrawnBlock {
  float model;
};

}  // namespace

VisibleSurfaceBinding::VisibleSurfaceBinding(const PassContext& frame, const SceneDraw& draw) {
  using shader::UniformSlot;
  const SceneSnapshot& snapshot = frame.snapshot();
  add(UniformSlot<ViewBlock>{"View"}({worldToClip(snapshot)}));
  add(UniformSlot<EyeBlock>{"Eye"}({.eyeWorld = snapshot.camera.eye, .imageSize = glm::vec2(pixels(frame))}));
  add(UniformSlot<DrawnBlock>{"Drawn"}({static_cast<float>(draw.model)}));
}

// With the near plane at 10^-4 of the far plane, single precision separates surfaces that are 6e-4 of the far
// distance apart. Seen from outside of the scene, the near plane is therefore at the scene's bounds.
glm::mat4 worldToClip(const SceneSnapshot& snapshot) {
  const CameraView& camera = snapshot.camera;
  const glm::vec3 farCorner =
      glm::max(glm::abs(snapshot.bounds.low - camera.eye), glm::abs(snapshot.bounds.high - camera.eye));
  const float far = std::max(glm::length(farCorner), 1e-6f) * 1.01f;
  const float aspect = static_cast<float>(camera.width) / static_cast<float>(camera.height);
  // Depth along the axis of a point seen in a corner of the image.
  const glm::vec3 nearest = glm::clamp(camera.eye, snapshot.bounds.low, snapshot.bounds.high);
  const float before = 0.99f * glm::length(nearest - camera.eye) /
                       glm::length(glm::vec3(1.0f, camera.tanHalfFov, camera.tanHalfFov * aspect));
  const float near = std::max(far * 1e-4f, before);
  const float fov = 2.0f * std::atan(camera.tanHalfFov);
  glm::mat4 projection = glm::perspectiveRH_ZO(fov, aspect, near, far);
  // The image moves against the rays. Clip space is 2 wide, and w is the negative z coordinate.
  projection[2][0] += 2.0f * camera.shift.x / static_cast<float>(camera.width);
  projection[2][1] -= 2.0f * camera.shift.y / static_cast<float>(camera.height);
  return projection * glm::lookAtRH(camera.eye, camera.eye + camera.forward, camera.up);
}

}  // namespace lumivox
