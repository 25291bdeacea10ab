// The captured picture as the view sees it.
#pragma once

#include "lumivox/toolkit/bindings.h"
#include "passes.h"

namespace lumivox::captured_frames {

/// Whether the camera stands where the newest frame was taken: from elsewhere the picture does not show what
/// lies behind virtual content.
inline bool isSameEye(const CapturedFrames& frames, const CameraView& view) {
  if (frames.count == 0) return false;
  constexpr float kSame = 1e-4f;
  const CaptureState& state = frames.states.front();
  const float turned =
      glm::length(view.forward - state.toWorld[2]) + glm::length(view.right - state.toWorld[0]);
  return glm::length(view.eye - state.eye) <= kSame && turned <= kSame;
}

/// The block Picture of picture.glsl, of a program's own type.
template <class Block>
Block pictureOf(const CapturedFrames& frames, const CameraView& view) {
  const CaptureCamera& camera = frames.camera;
  const auto& k = camera.distortion;
  const auto number = [](double value) { return static_cast<float>(value); };
  return {.tanHalfFov = view.tanHalfFov,
          .width = camera.width,
          .height = camera.height,
          .shift = view.shift,
          .focal = glm::vec2(camera.focal),
          .centre = glm::vec2(camera.centre),
          .radial = {number(k[0]), number(k[1]), number(k[4]), 0.0f},
          .tangential = {number(k[2]), number(k[3])},
          .eye = view.eye,
          .right = view.right,
          .down = -view.up,
          .forward = view.forward};
}

/// In place of an input that is not connected.
inline gpu::TextureRef blackImage(PassContext& frame) {
  gpu::TextureRef black = frame.image("no light");
  black->clear(glm::vec4(0.0f));
  return black;
}

}  // namespace lumivox::captured_frames
