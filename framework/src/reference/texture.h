// Textures as rays read them: few bytes a texel, because rays that bounce read them all over the place.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox::reference {

class Texture {
 public:
  explicit Texture(const SurfaceTexture& source);

  /// Four texels and their weights.
  struct Place {
    std::size_t upperLeft, upperRight, lowerLeft, lowerRight;
    float right, lower;
  };
  /// Where a bilinear lookup reads, with the texture repeated: texel centres at half integers, v = 1 at the
  /// top row. Asks for the texels, so that they are near when read() needs them.
  Place find(const glm::vec2& texcoord) const {
    const Axis column = axisOf(texcoord.x, width_), row = axisOf(-texcoord.y, height_);
    const std::size_t top = row.first * static_cast<std::size_t>(width_);
    const std::size_t bottom = row.second * static_cast<std::size_t>(width_);
    if (!packed_.empty()) {
      __builtin_prefetch(&packed_[top + column.first]);
      __builtin_prefetch(&packed_[bottom + column.first]);
    }
    return {top + column.first,     top + column.second, bottom + column.first,
            bottom + column.second, column.weight,       row.weight};
  }
  /// The bilinear value. A mask gives its coverage in every channel.
  glm::vec3 read(const Place& place) const {
    const glm::vec3 upper =
        (1.0f - place.right) * texel(place.upperLeft) + place.right * texel(place.upperRight);
    const glm::vec3 lower =
        (1.0f - place.right) * texel(place.lowerLeft) + place.right * texel(place.lowerRight);
    return (1.0f - place.lower) * upper + place.lower * lower;
  }

 private:
  /// Two neighbouring texels along one axis and the weight of the second.
  struct Axis {
    std::size_t first, second;
    float weight;
  };
  static Axis axisOf(float coordinate, int size) {
    // Beyond 2^23 a float has no fraction left, and no place in the texture.
    if (!(coordinate > -0x1.0p23f && coordinate < 0x1.0p23f)) coordinate = 0.0f;
    const float fraction = coordinate - floorOf(coordinate);
    const float place = fraction * static_cast<float>(size) - 0.5f;
    const float below = floorOf(place);
    const int first = static_cast<int>(below);  // -1 to size - 1
    return {static_cast<std::size_t>(first < 0 ? size - 1 : std::min(first, size - 1)),
            static_cast<std::size_t>(first + 1 >= size ? 0 : first + 1), place - below};
  }
  /// Without a call of the mathematical library, which the oldest processors of the architecture need.
  static float floorOf(float value) {
    const auto truncated = static_cast<float>(static_cast<int>(value));
    return truncated - (truncated > value ? 1.0f : 0.0f);
  }
  glm::vec3 texel(std::size_t index) const {
    if (packed_.empty()) return wide_[index];
    const std::uint32_t bytes = packed_[index];
    return {palette_[bytes & 0xffu], palette_[bytes >> 8 & 0xffu], palette_[bytes >> 16 & 0xffu]};
  }

  int width_, height_;
  /// Pictures with 8 bits per channel have at most 256 values, whatever curve decoded them: a texel is three
  /// indices into them.
  std::array<float, 256> palette_{};
  std::vector<std::uint32_t> packed_;
  std::vector<glm::vec3> wide_;  ///< texels of all other pictures; then packed_ is empty
};

}  // namespace lumivox::reference
