// Closed rooms for tests of the visibility between surface elements.
#pragma once

#include <random>

#include "support/scene_builder.h"

namespace lumivox::test {

/// A closed cube of 1 m: every direction bin of its walls sees a wall.
inline Scene closedCube(float albedo = 0.5f) {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 1}, builder.lambert(albedo), true);
  return builder.scene;
}

/// The cube with two boxes on its floor; `moving`: the smaller one travels along x.
inline Scene furnishedCube(bool moving = false) {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.box({0, 0, 0}, {1, 1, 1}, grey, true);
  // A gap below the boxes, since surfaces in contact see nothing.
  builder.box({0.15f, 0.01f, 0.2f}, {0.45f, 0.6f, 0.5f}, grey, false);
  const std::size_t first = builder.scene.objects.size();
  builder.box({0.55f, 0.01f, 0.55f}, {0.85f, 0.3f, 0.85f}, grey, false);
  if (moving)
    for (std::size_t i = first; i < builder.scene.objects.size(); ++i) {
      RigidMotion motion;
      motion.velocity = {-0.05, 0.01, 0.02};
      builder.scene.objects[i].motion = motion;
    }
  builder.look({0.5, 0.5, 0.95}, {0.5, 0.5, 0}, {0, 1, 0}, 1.2, 16, 12);
  return builder.scene;
}

}  // namespace lumivox::test
