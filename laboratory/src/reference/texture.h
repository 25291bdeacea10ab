// Textures for rays: few bytes a texel, because bouncing rays access them incoherently.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/scene/bilinear.h"
#include "lumivox/scene/scene.h"

namespace lumivox::reference {

class Texture {
 public:
  explicit Texture(const SurfaceTexture& source);

  using Place = BilinearPlace;
  /// The texels of a bilinear lookup; prefetches them for read().
  Place find(const glm::vec2& texcoord) const {
    const Place place = bilinearPlace(texcoord, width_, height_);
    if (!packed_.empty()) {
      __builtin_prefetch(&packed_[place.upperLeft]);
      __builtin_prefetch(&packed_[place.lowerLeft]);
    }
    return place;
  }
  /// The bilinear value. A mask gives its coverage in every channel.
  glm::vec3 read(const Place& place) const {
    return place.blend([&](std::size_t index) { return texel(index); });
  }

 private:
  glm::vec3 texel(std::size_t index) const {
    if (packed_.empty()) return wide_[index];
    const std::uint32_t bytes = packed_[index];
    return {palette_[bytes & 0xffu], palette_[bytes >> 8 & 0xffu], palette_[bytes >> 16 & 0xffu]};
  }

  int width_, height_;
  /// Images with 8 bits per channel have at most 256 values, whatever curve decoded them: a texel is three
  /// indices into them.
  std::array<float, 256> palette_{};
  std::vector<std::uint32_t> packed_;
  std::vector<glm::vec3> wide_;  ///< texels of images with more than 256 values; packed_ is then empty
};

}  // namespace lumivox::reference
