#include "vdbexport/texels.h"

#include <fmt/format.h>
#include <openvdb/math/Half.h>

#include "lumivox/base/error.h"

namespace lumivox::vdb {
namespace {

glm::ivec3 sizeOf(const gpu::Texture& texture) {
  const gpu::TextureDescription& description = texture.description();
  return {description.width, description.height, description.depth};
}

bool anyBit(const std::byte* bytes, std::size_t count) {
  std::uint64_t bits = 0;
  for (; count >= sizeof(bits); bytes += sizeof(bits), count -= sizeof(bits))
    bits |= detail::readAs<std::uint64_t>(bytes);
  for (; count > 0; ++bytes, --count) bits |= static_cast<std::uint64_t>(*bytes);
  return bits != 0;
}

struct Half {
  std::uint16_t bits;
};
float asFloat(std::uint8_t byte) {
  return static_cast<float>(byte) / 255.0f;
}
float asFloat(Half stored) {
  openvdb::math::half half;
  half.setBits(stored.bits);
  return half;
}
float asFloat(float value) {
  return value;
}

template <class Stored, int kComponents>
void decodeRow(const std::byte* texels, int count, glm::vec4* values) {
  for (int i = 0; i < count; ++i) {
    values[i] = glm::vec4(0.0f);
    for (int c = 0; c < kComponents; ++c)
      values[i][c] = asFloat(
          detail::readAs<Stored>(texels + static_cast<std::size_t>(i * kComponents + c) * sizeof(Stored)));
  }
}

}  // namespace

glm::ivec3 levelResolution(const glm::ivec3& finest, int level) {
  return glm::max(glm::ivec3(finest.x >> level, finest.y >> level, finest.z >> level), glm::ivec3(1));
}

Texels::Texels(gpu::TextureRef texture, int level)
    : texture_(std::move(texture)),
      level_(level),
      layout_(levelResolution(sizeOf(*texture_), level)),
      texelBytes_(gpu::bytesPerTexel(texture_->description().format)) {}

std::uint64_t Texels::sizeBytes() const {
  const glm::u64vec3 size(layout_.resolution);
  return size.x * size.y * size.z * texelBytes_;
}

void Texels::load() {
  if (!bytes_.empty()) return;
  requireMemory(sizeBytes(), fmt::format("downloading {}", texture_->label()));
  bytes_ = texture_->download(level_);
  findOccupied();
}

void Texels::findOccupied() {
  occupied_.assign(layout_.count(), 0);
  // A thread takes whole layers of leaves, so that no two write beside each other and reading is in order.
  const auto leavesX = static_cast<std::size_t>(layout_.leaves.x),
             leavesY = static_cast<std::size_t>(layout_.leaves.y);
  tbb::parallel_for(0, layout_.leaves.z, [&](int layer) {
    const int end = std::min((layer + 1) * kLeaf, layout_.resolution.z);
    for (int z = layer * kLeaf; z < end; ++z)
      for (int y = 0; y < layout_.resolution.y; ++y)
        for (std::size_t i = 0; i < leavesX; ++i) {
          char& occupied = occupied_[i + leavesX * (static_cast<std::size_t>(y / kLeaf) +
                                                    leavesY * static_cast<std::size_t>(layer))];
          if (occupied != 0) continue;
          const int x = static_cast<int>(i) * kLeaf;
          const auto count = static_cast<std::size_t>(std::min(kLeaf, layout_.resolution.x - x));
          if (anyBit(at({x, y, z}), count * texelBytes_)) occupied = 1;
        }
  });
}

detail::DecodeRow detail::decoderOf(gpu::Format format, std::string_view what) {
  using gpu::Format;
  switch (format) {
    case Format::r8:
      return decodeRow<std::uint8_t, 1>;
    case Format::rgba8:
      return decodeRow<std::uint8_t, 4>;
    case Format::r16f:
      return decodeRow<Half, 1>;
    case Format::rg16f:
      return decodeRow<Half, 2>;
    case Format::rgba16f:
      return decodeRow<Half, 4>;
    case Format::r32f:
      return decodeRow<float, 1>;
    case Format::rg32f:
      return decodeRow<float, 2>;
    case Format::rgba32f:
      return decodeRow<float, 4>;
    default:
      throw Error(fmt::format("{}: its texture has the format {}; expected floats or bytes", what,
                              gpu::name(format)));
  }
}

}  // namespace lumivox::vdb
