#include "vdbexport/texels.h"

#include <fmt/format.h>
#include <openvdb/math/Half.h>
#include <tbb/task_group.h>

#include <span>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/port.h"

namespace lumivox::vdb {
namespace {

glm::ivec3 sizeOf(const gpu::Texture& texture) {
  const gpu::TextureDescription& description = texture.description();
  return {description.width, description.height, description.depth};
}

/// Whether any byte is not zero: all are zero if the first one is and each equals the one before it.
bool anyBit(const std::byte* bytes, std::size_t count) {
  return bytes[0] != std::byte{0} || std::memcmp(bytes, bytes + 1, count - 1) != 0;
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
glm::vec4 decode(const std::byte* texel) {
  glm::vec4 values(0.0f);
  for (int c = 0; c < kComponents; ++c)
    values[c] = asFloat(detail::readAs<Stored>(texel + static_cast<std::size_t>(c) * sizeof(Stored)));
  return values;
}

}  // namespace

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
  if (!leaves_.empty()) return;
  const std::uint64_t atMost = sizeBytes() + layout_.count() * sizeof(Leaf);
  requireMemory(atMost, fmt::format("downloading {}", texture_->label()));
  leaves_.resize(layout_.count());
  texels_.resize(layout_.count() / static_cast<std::size_t>(layout_.leaves.x));
  // Texels pass one layer of leaves at a time through buffers that stay in the caches: the empty part,
  // usually nearly all of the volume, is never written to memory. One layer is searched while the next is
  // downloaded.
  std::array<std::vector<std::byte>, 2> buffers;
  tbb::task_group searching;
  try {
    for (int layer = 0; layer < layout_.leaves.z; ++layer) {
      const int first = layer * kLeaf, count = std::min(kLeaf, layout_.resolution.z - first);
      std::vector<std::byte>& buffer = buffers[static_cast<std::size_t>(layer % 2)];
      buffer.resize(sliceBytes() * static_cast<std::size_t>(count));
      texture_->downloadSlices(level_, first, count, buffer);
      searching.wait();
      searching.run([this, layer, &buffer] { keepLayer(layer, buffer); });
    }
    searching.wait();
  } catch (...) {
    searching.wait();
    leaves_.clear();
    throw;
  }
}

void Texels::keepLayer(int layer, const std::vector<std::byte>& slices) {
  const int count = std::min(kLeaf, layout_.resolution.z - layer * kLeaf);
  tbb::parallel_for(0, layout_.leaves.y, [&](int i) {
    const int y = i * kLeaf;
    const std::byte* first = slices.data() + volumeRowBytes() * static_cast<std::size_t>(y);
    const auto leafRow = static_cast<std::size_t>(i + layout_.leaves.y * layer);
    findKept(leafRow, {std::min(kLeaf, layout_.resolution.y - y), count}, first);
    keepRow(leafRow, first);
  });
}

/// Notes which texels of a row of leaves to keep. `slices` begins at the row's first texel. `extent`: voxels
/// of the leaves along y and z.
void Texels::findKept(std::size_t leafRow, const glm::ivec2& extent, const std::byte* slices) {
  const auto leavesX = static_cast<std::size_t>(layout_.leaves.x);
  const std::size_t partBytes = kLeaf * texelBytes_;
  for (std::size_t z = 0; z < static_cast<std::size_t>(extent.y); ++z)
    for (std::size_t y = 0; y < static_cast<std::size_t>(extent.x); ++y) {
      const std::byte* row = slices + z * sliceBytes() + y * volumeRowBytes();
      if (!anyBit(row, volumeRowBytes())) continue;
      for (std::size_t i = 0; i < leavesX; ++i) {
        const std::byte* part = row + i * partBytes;
        const std::size_t size = std::min(partBytes, volumeRowBytes() - i * partBytes);
        if (!anyBit(part, size)) continue;
        std::uint64_t bits = 0;
        for (std::size_t x = 0; x * texelBytes_ < size; ++x)
          bits |= static_cast<std::uint64_t>(anyBit(part + x * texelBytes_, texelBytes_)) << x;
        leaves_[i + leavesX * leafRow].kept[z] |= bits << (kLeaf * y);
      }
    }
}

void Texels::keepRow(std::size_t leafRow, const std::byte* slices) {
  const auto leavesX = static_cast<std::size_t>(layout_.leaves.x);
  const std::span<Leaf> leaves = std::span(leaves_).subspan(leafRow * leavesX, leavesX);
  std::size_t bytes = 0;
  for (Leaf& leaf : leaves) {
    leaf.firstByte = bytes;
    for (const std::uint64_t word : leaf.kept)
      bytes += texelBytes_ * static_cast<std::size_t>(std::popcount(word));
  }
  if (bytes == 0) return;
  texels_[leafRow] = std::make_unique_for_overwrite<std::byte[]>(bytes);
  std::byte* to = texels_[leafRow].get();
  for (std::size_t i = 0; i < leavesX; ++i)
    for (std::size_t z = 0; z < kLeaf; ++z)
      for (std::uint64_t bits = leaves[i].kept[z]; bits != 0; bits &= bits - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(bits));
        std::memcpy(to,
                    slices + z * sliceBytes() + bit / kLeaf * volumeRowBytes() +
                        (i * kLeaf + bit % kLeaf) * texelBytes_,
                    texelBytes_);
        to += texelBytes_;
      }
}

detail::Decode detail::decoderOf(gpu::Format format, std::string_view what) {
  using gpu::Format;
  switch (format) {
    case Format::r8:
      return decode<std::uint8_t, 1>;
    case Format::rgba8:
      return decode<std::uint8_t, 4>;
    case Format::r16f:
      return decode<Half, 1>;
    case Format::rg16f:
      return decode<Half, 2>;
    case Format::rgba16f:
      return decode<Half, 4>;
    case Format::r32f:
      return decode<float, 1>;
    case Format::rg32f:
      return decode<float, 2>;
    case Format::rgba32f:
      return decode<float, 4>;
    default:
      throw Error(fmt::format("{}: its texture has the format {}; expected floats or bytes", what,
                              gpu::name(format)));
  }
}

}  // namespace lumivox::vdb
