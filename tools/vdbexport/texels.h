// A mip level of a volume on the host: its texels that are not zero.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <memory>
#include <vector>

#include "lumivox/gpu/device.h"
#include "vdbexport/sparse.h"

namespace lumivox::vdb {

/// The texels of a volume level that have any bit set, leaf by leaf. They are downloaded when first needed,
/// and kept with this object. Several grids may be made from one.
class Texels {
 public:
  Texels(gpu::TextureRef texture, int level);

  gpu::Format format() const { return texture_->description().format; }
  const LeafLayout& layout() const { return layout_; }
  std::uint64_t sizeBytes() const;  ///< of the level on the device
  /// Error when the memory does not suffice.
  void load();
  /// Whether any texel of a leaf is kept. Call it after load().
  bool occupied(std::size_t leaf) const {
    return std::any_of(leaves_[leaf].kept.begin(), leaves_[leaf].kept.end(),
                       [](std::uint64_t word) { return word != 0; });
  }
  /// Calls `work(voxel in the leaf, bytes of its texel)` for the texels of a leaf that are kept.
  template <class Work>
  void forEach(std::size_t leaf, Work&& work) const {
    const std::byte* bytes =
        texels_[leaf / static_cast<std::size_t>(layout_.leaves.x)].get() + leaves_[leaf].firstByte;
    for (int z = 0; z < kLeaf; ++z)
      for (std::uint64_t bits = leaves_[leaf].kept[static_cast<std::size_t>(z)]; bits != 0;
           bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        work(glm::ivec3(bit % kLeaf, bit / kLeaf, z), bytes);
        bytes += texelBytes_;
      }
  }

 private:
  struct Leaf {
    std::array<std::uint64_t, kLeaf> kept{};  ///< texel (x, y, z) is bit x + 8 y of word z
    std::size_t firstByte = 0;                ///< offset in the texels of its row of leaves
  };
  void keepLayer(int layer, const std::vector<std::byte>& slices);
  void findKept(std::size_t leafRow, const glm::ivec2& extent, const std::byte* slices);
  void keepRow(std::size_t leafRow, const std::byte* slices);
  std::size_t volumeRowBytes() const { return static_cast<std::size_t>(layout_.resolution.x) * texelBytes_; }
  std::size_t sliceBytes() const { return volumeRowBytes() * static_cast<std::size_t>(layout_.resolution.y); }

  gpu::TextureRef texture_;
  int level_;
  LeafLayout layout_;
  std::size_t texelBytes_;
  std::vector<Leaf> leaves_;
  std::vector<std::unique_ptr<std::byte[]>> texels_;  ///< kept texels of each row of leaves along x
};
using TexelsRef = std::shared_ptr<Texels>;

namespace detail {

template <class T>
T readAs(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// A texel as floats; components that the format does not have are 0.
using Decode = glm::vec4 (*)(const std::byte* texel);
/// Error, naming `what`, for integer and depth formats.
Decode decoderOf(gpu::Format format, std::string_view what);

}  // namespace detail

/// A grid from textures of one format and size. A voxel is active if any component of any texture differs
/// from zero, so that all grids from the same textures have the same active voxels. `select` computes the
/// value from the voxel's texels.
template <class GridType, std::size_t kCount, class Select>
typename GridType::Ptr gridOf(const std::array<TexelsRef, kCount>& sources, std::string_view what,
                              const Select& select) {
  static_assert(!std::is_same_v<typename GridType::ValueType, bool>, "bits are packed otherwise");
  using Node = typename GridType::TreeType::LeafNodeType;
  for (const TexelsRef& source : sources) source->load();
  const detail::Decode decode = detail::decoderOf(sources[0]->format(), what);
  const LeafLayout& layout = sources[0]->layout();
  const auto occupied = [&](std::size_t leaf) {
    return std::any_of(sources.begin(), sources.end(),
                       [&](const TexelsRef& source) { return source->occupied(leaf); });
  };
  const auto fill = [&](std::size_t leaf, Node& node) {
    typename GridType::ValueType* values = node.buffer().data();
    if constexpr (kCount == 1) {
      sources[0]->forEach(leaf, [&](const glm::ivec3& voxel, const std::byte* bytes) {
        const std::array<glm::vec4, 1> texel{decode(bytes)};
        if (texel[0] == glm::vec4(0.0f)) return;  // minus zero
        const openvdb::Index offset = Node::coordToOffset({voxel.x, voxel.y, voxel.z});
        values[offset] = select(texel);
        node.setValueOn(offset);
      });
    } else {
      std::array<std::array<glm::vec4, kCount>, Node::SIZE> texels{};
      for (std::size_t i = 0; i < kCount; ++i)
        sources[i]->forEach(leaf, [&](const glm::ivec3& voxel, const std::byte* bytes) {
          const openvdb::Index offset = Node::coordToOffset({voxel.x, voxel.y, voxel.z});
          texels[offset][i] = decode(bytes);
          if (texels[offset][i] != glm::vec4(0.0f)) node.setValueOn(offset);
        });
      for (auto voxel = node.beginValueOn(); voxel; ++voxel)
        values[voxel.pos()] = select(texels[voxel.pos()]);
    }
  };
  return sparseGrid<GridType>(layout, what, occupied, fill);
}

}  // namespace lumivox::vdb
