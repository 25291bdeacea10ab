#include "reference/texture.h"

#include <bit>
#include <optional>
#include <unordered_map>

namespace lumivox::reference {
namespace {

/// Numbers the distinct values of an image; nothing when there are more than 256.
std::optional<std::vector<std::uint8_t>> indicesOf(const std::vector<float>& values,
                                                   std::array<float, 256>& palette) {
  std::unordered_map<std::uint32_t, std::uint8_t> known;
  std::vector<std::uint8_t> indices(values.size());
  std::uint32_t lastBits = 0;
  std::uint8_t last = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto bits = std::bit_cast<std::uint32_t>(values[i]);
    if (known.empty() || bits != lastBits) {
      const auto [entry, isNew] = known.try_emplace(bits, static_cast<std::uint8_t>(known.size()));
      if (isNew) {
        if (known.size() > palette.size()) return std::nullopt;
        palette[entry->second] = values[i];
      }
      lastBits = bits;
      last = entry->second;
    }
    indices[i] = last;
  }
  return indices;
}

}  // namespace

Texture::Texture(const SurfaceTexture& source) : width_(source.width), height_(source.height) {
  const std::size_t texels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  const std::size_t channels = source.mask ? 1 : 3;
  const auto channel = [&](std::size_t texel, std::size_t index) {
    return texel * channels + (source.mask ? 0 : index);
  };
  if (const auto indices = indicesOf(source.values, palette_)) {
    packed_.reserve(texels);
    for (std::size_t i = 0; i < texels; ++i) {
      packed_.push_back(std::uint32_t{(*indices)[channel(i, 0)]} |
                        std::uint32_t{(*indices)[channel(i, 1)]} << 8 |
                        std::uint32_t{(*indices)[channel(i, 2)]} << 16);
    }
    return;
  }
  wide_.reserve(texels);
  for (std::size_t i = 0; i < texels; ++i) {
    wide_.emplace_back(source.values[channel(i, 0)], source.values[channel(i, 1)],
                       source.values[channel(i, 2)]);
  }
}

}  // namespace lumivox::reference
