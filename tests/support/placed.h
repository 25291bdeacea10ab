// Placing objects of scenes that tests build.
#pragma once

#include <utility>

#include "lumivox/scene/scene.h"

namespace lumivox::test {

/// Places an object as the loader does: where the placement mirrors, the winding of its triangles is
/// reversed, so that the front side stays with the surface.
inline void place(Scene& scene, Object& object, const glm::dmat4& placement) {
  const auto mirrors = [](const glm::dmat4& matrix) { return glm::determinant(glm::dmat3(matrix)) < 0.0; };
  if (mirrors(placement) != mirrors(object.placement)) {
    for (const Part& part : object.parts)
      for (std::uint32_t i = part.firstIndex; i + 2 < part.firstIndex + part.indexCount; i += 3)
        std::swap(scene.indices[i + 1], scene.indices[i + 2]);
  }
  object.placement = placement;
}

}  // namespace lumivox::test
