#pragma once

#include "scene_builder.h"

namespace lumivox::test {

/// A sheet of 2 m whose left half is masked out, 0.5 m above an unmasked sheet.
inline void addHalfMaskedSheet(SceneBuilder& builder) {
  SurfaceTexture half;
  half.width = 2, half.height = 1, half.mask = true;
  half.values = {0.0f, 1.0f};
  Material masked;
  masked.diffuse = glm::vec3(0.5f);
  masked.maskTexture = static_cast<int>(builder.scene.textures.size());
  builder.scene.textures.push_back(half);
  builder.quad({-1, 0.5f, 1}, {2, 0, 0}, {0, 0, -2}, builder.material(masked));
  builder.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, builder.lambert(0.25f));
}

}  // namespace lumivox::test
