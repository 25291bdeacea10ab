// Common parts of the marches through media.
#pragma once

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/media.h"

namespace lumivox::volumetric_smoke {

// Of both marches.
enum class Resolution { full, half };
constexpr auto words(Resolution) {
  return std::array{"full", "half"};
}

/// Block View of range.glsl. Its mirrors in the shaders' headers have the same members.
template <class View>
View viewOf(const CameraView& camera, int pixelsPerSample) {
  View view{};
  view.eyeWorld = camera.eye;
  view.pixelsPerSample = pixelsPerSample;
  view.cornerDirection = camera.direction(0.0f, 0.0f);
  view.perColumn = camera.direction(1.0f, 0.0f) - view.cornerDirection;
  view.perRow = camera.direction(0.0f, 1.0f) - view.cornerDirection;
  return view;
}

/// Samples of a march along either side of the image, with one for 2 x 2 pixels or for each.
inline glm::ivec2 samplesOf(const CameraView& camera, int pixelsPerSample) {
  return (glm::ivec2(camera.width, camera.height) + pixelsPerSample - 1) / pixelsPerSample;
}

/// Two images: scattered radiance and transmittance.
struct Result {
  gpu::TextureRef scattered, transmittance;
  Result(PassContext& frame, const glm::ivec2& size) {
    const gpu::TextureDescription image{gpu::TextureKind::d2, gpu::Format::rgba32f, size.x, size.y, 1, 1};
    scattered = frame.texture(image, "scattered radiance");
    transmittance = frame.texture(image, "transmittance");
  }
};

void addMarchAsPublished(TechniqueRegistry& registry);

}  // namespace lumivox::volumetric_smoke
