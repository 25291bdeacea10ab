// Environment maps made by code.
#pragma once

#include <cmath>
#include <memory>

#include "lumivox/scene/scene.h"

namespace lumivox::test {

/// A map whose texels have the radiance of the direction through their middle.
template <class RadianceTowards>
EnvironmentMap environmentOf(int height, RadianceTowards&& towards) {
  EnvironmentMap map;
  map.width = 2 * height;
  map.height = height;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < map.width; ++column)
      map.radiance.push_back(
          towards(map.direction(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f)));
  map.finish();
  return map;
}

/// Also where it is constant, unlike the loader.
inline void shineFrom(Scene& scene, EnvironmentMap map) {
  scene.environment = map.mean();
  scene.environmentMap = std::make_shared<const EnvironmentMap>(std::move(map));
}

}  // namespace lumivox::test
