// Bilinear look-ups of textures on the host: the same texels and weights as those of the shaders' linear,
// repeating samplers. For the path tracer and for preprocessing of scenes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// A mask's coverage below this is a hole; kMaskThreshold of shaders/common/scene.glsl.
inline constexpr float kMaskThreshold = 0.5f;

/// Four texels, as indices row by row from the top, and the weights of the right and of the lower two.
struct BilinearPlace {
  std::size_t upperLeft, upperRight, lowerLeft, lowerRight;
  float right, lower;

  /// The bilinear value of what `texel(index)` gives.
  template <class Texel>
  auto blend(Texel&& texel) const {
    const auto above = (1.0f - right) * texel(upperLeft) + right * texel(upperRight);
    const auto below = (1.0f - right) * texel(lowerLeft) + right * texel(lowerRight);
    return (1.0f - lower) * above + lower * below;
  }
};

/// Two neighbouring texels along one axis, the texture repeated, and the weight of the second.
struct LinearPlace {
  std::size_t first, second;
  float weight;
};

/// `coordinate` counts in textures of `size` texels; texel centres lie at half integers.
inline LinearPlace linearPlace(float coordinate, int size) {
  // Without a call of the mathematical library, which the oldest processors of the architecture need.
  const auto floorOf = [](float value) {
    const auto truncated = static_cast<float>(static_cast<int>(value));
    return truncated - (truncated > value ? 1.0f : 0.0f);
  };
  // Beyond 2^23 a float has no fraction left, and no place in the texture.
  if (!(coordinate > -0x1.0p23f && coordinate < 0x1.0p23f)) coordinate = 0.0f;
  const float fraction = coordinate - floorOf(coordinate);
  const float place = fraction * static_cast<float>(size) - 0.5f;
  const float below = floorOf(place);
  const int first = static_cast<int>(below);  // -1 to size - 1
  return {static_cast<std::size_t>(first < 0 ? size - 1 : std::min(first, size - 1)),
          static_cast<std::size_t>(first + 1 >= size ? 0 : first + 1), place - below};
}

/// Where a lookup at a texture coordinate reads; v = 1 is the top row.
inline BilinearPlace bilinearPlace(const glm::vec2& texcoord, int width, int height) {
  const LinearPlace column = linearPlace(texcoord.x, width), row = linearPlace(-texcoord.y, height);
  const std::size_t top = row.first * static_cast<std::size_t>(width);
  const std::size_t bottom = row.second * static_cast<std::size_t>(width);
  return {top + column.first,     top + column.second, bottom + column.first,
          bottom + column.second, column.weight,       row.weight};
}

/// Whether a mask (SurfaceTexture::mask) cuts a surface out at a texture coordinate.
inline bool cutOut(const SurfaceTexture& mask, const glm::vec2& texcoord) {
  return bilinearPlace(texcoord, mask.width, mask.height).blend([&](std::size_t index) {
    return mask.values[index];
  }) < kMaskThreshold;
}

}  // namespace lumivox
