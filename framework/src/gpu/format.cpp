#include <array>
#include <bit>

#include "gpu/state.h"

namespace lumivox::gpu {

const FormatTraits& traitsOf(Format format) {
  // In the order of the enumeration.
  static constexpr std::array<FormatTraits, 12> kTraits{{
      {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 1, false, false, "r8"},
      {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4, 4, false, false, "rgba8"},
      {GL_R16F, GL_RED, GL_HALF_FLOAT, 1, 2, false, false, "r16f"},
      {GL_RG16F, GL_RG, GL_HALF_FLOAT, 2, 4, false, false, "rg16f"},
      {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 4, 8, false, false, "rgba16f"},
      {GL_R32F, GL_RED, GL_FLOAT, 1, 4, false, false, "r32f"},
      {GL_RG32F, GL_RG, GL_FLOAT, 2, 8, false, false, "rg32f"},
      {GL_RGBA32F, GL_RGBA, GL_FLOAT, 4, 16, false, false, "rgba32f"},
      {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 1, 4, true, false, "r32ui"},
      {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 2, 8, true, false, "rg32ui"},
      {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 4, 16, true, false, "rgba32ui"},
      {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 1, 4, false, true, "depth32f"},
  }};
  return kTraits[static_cast<std::size_t>(format)];
}

std::size_t bytesPerTexel(Format format) {
  return static_cast<std::size_t>(traitsOf(format).bytesPerTexel);
}
int componentCount(Format format) {
  return traitsOf(format).components;
}
const char* name(Format format) {
  return traitsOf(format).name;
}

std::uint64_t TextureDescription::sizeBytes() const {
  std::uint64_t texels = 0;
  for (int level = 0; level < levels; ++level) {
    const auto extent = [level](int size) { return static_cast<std::uint64_t>(std::max(1, size >> level)); };
    texels += extent(width) * extent(height) *
              (kind == TextureKind::d3 ? extent(depth) : static_cast<std::uint64_t>(depth));
  }
  return texels * bytesPerTexel(format);
}

int fullLevelCount(int width, int height, int depth) {
  return std::bit_width(static_cast<unsigned>(std::max({width, height, depth, 1})));
}

}  // namespace lumivox::gpu
