// Common parts of the marches through media.
#pragma once

#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/media.h"
#include "volumetric_smoke_shaders.h"

namespace lumivox::volumetric_smoke {

// Of both marches.
enum class Resolution { full, half };

/// Block View of range.glsl.
inline gpu::ResourceBinding viewOf(const CameraView& camera, int pixelsPerSample) {
  const glm::vec3 corner = camera.direction(0.0f, 0.0f);
  return shader::UniformSlot<shaders::volumetric_smoke::View>{"View"}(
      {.eyeWorld = camera.eye,
       .pixelsPerSample = pixelsPerSample,
       .cornerDirection = corner,
       .perColumn = camera.direction(1.0f, 0.0f) - corner,
       .perRow = camera.direction(0.0f, 1.0f) - corner});
}

/// Numbers of samples along both sides of the image: one for each pixel or for 2 x 2 pixels.
inline glm::ivec2 samplesOf(const CameraView& camera, int pixelsPerSample) {
  return (glm::ivec2(camera.width, camera.height) + pixelsPerSample - 1) / pixelsPerSample;
}

/// Makes both result images of a march or of its upsampling.
inline void makeImages(PassContext& frame, const glm::ivec2& size, Out<Image>& scattered,
                       Out<Image>& transmittance) {
  const gpu::TextureDescription image{gpu::TextureKind::d2, gpu::Format::rgba32f, size.x, size.y, 1, 1};
  scattered = Image{frame.texture(image, "scattered radiance")};
  transmittance = Image{frame.texture(image, "transmittance"), false};
}

void addMarchAsPublished(TechniqueRegistry& registry);

}  // namespace lumivox::volumetric_smoke
