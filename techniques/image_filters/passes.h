// The passes of image_filters that have a source of their own.
#pragma once

#include "lumivox/plugin/technique.h"

namespace lumivox::image_filters {

void addAccumulate(TechniqueRegistry& registry);
void addAtrous(TechniqueRegistry& registry);

/// Width of a pixel at a distance of 1.
inline float pixelAngleOf(const CameraView& camera) {
  return 2.0f * camera.tanHalfFov / static_cast<float>(camera.height);
}

}  // namespace lumivox::image_filters
