// A clear sky as an environment map: light from the horizon up to the zenith, a sun of four texels, dull
// ground.
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "lumivox/base/image.h"
#include "lumivox/scene/environment.h"
#include "models.h"

namespace lumivox::models {

void writeSky(const std::filesystem::path& directory) {
  constexpr int kHeight = 64;
  // Of the sun's four texels: 40 degrees over the horizon, to the right of -Z and towards +Z.
  constexpr int kSunRow = 17, kSunColumn = 83;
  constexpr double kSunIrradiance = 9.0;  // W/m^2 on a plane that faces it
  const glm::vec3 zenith(0.16f, 0.3f, 0.62f), horizon(0.75f, 0.82f, 0.9f), ground(0.11f, 0.1f, 0.08f),
      sunlight(1.0f, 0.93f, 0.8f);
  EnvironmentMap map;
  map.width = 2 * kHeight;
  map.height = kHeight;
  ImageBuffer image(map.width, map.height, 3);
  const auto isSun = [](int x, int y) {
    return (x == kSunColumn || x == kSunColumn + 1) && (y == kSunRow || y == kSunRow + 1);
  };
  const double sun = kSunIrradiance / (2.0 * (map.solidAngle(kSunRow) + map.solidAngle(kSunRow + 1)));
  for (int y = 0; y < map.height; ++y) {
    const float up = map.direction(0.5f, static_cast<float>(y) + 0.5f).y;
    const glm::vec3 radiance = up > 0.0f ? glm::mix(horizon, zenith, std::sqrt(up))
                                         : glm::mix(0.6f * horizon, ground, std::min(1.0f, -8.0f * up));
    for (int x = 0; x < map.width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = isSun(x, y) ? static_cast<float>(sun) * sunlight[c] : radiance[c];
  }
  LayeredImage layered;
  layered.layers.emplace("", std::move(image));
  writeExr(directory / "sky.exr", layered);
}

}  // namespace lumivox::models
