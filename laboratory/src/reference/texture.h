// Textures as rays read them: few bytes a texel, because rays that bounce read them all over the place.
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
  /// Where a bilinear lookup reads. Asks for the texels, so that they are near when read() needs them.
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
  std::vector<glm::vec3> wide_;  ///< texels of all other images; then packed_ is empty
};

}  // namespace lumivox::reference
