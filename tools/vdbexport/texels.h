// Texels of one mip level on the host, and which leaves hold anything.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <memory>
#include <vector>

#include "lumivox/gpu/device.h"
#include "vdbexport/sparse.h"

namespace lumivox::vdb {

/// A volume level, downloaded when it is first needed and kept while somebody holds it. Several grids may
/// come from one.
class Texels {
 public:
  Texels(gpu::TextureRef texture, int level);

  gpu::Format format() const { return texture_->description().format; }
  const LeafLayout& layout() const { return layout_; }
  std::uint64_t sizeBytes() const;
  /// Error when the memory does not suffice.
  void load();
  /// False only for a leaf whose texels are zero to the bit. After load().
  bool occupied(std::size_t leaf) const { return occupied_[leaf] != 0; }
  const std::byte* at(const glm::ivec3& voxel) const {
    const auto x = static_cast<std::size_t>(layout_.resolution.x),
               y = static_cast<std::size_t>(layout_.resolution.y);
    return bytes_.data() +
           texelBytes_ * (static_cast<std::size_t>(voxel.x) +
                          x * (static_cast<std::size_t>(voxel.y) + y * static_cast<std::size_t>(voxel.z)));
  }

 private:
  void findOccupied();
  gpu::TextureRef texture_;
  int level_;
  LeafLayout layout_;
  std::size_t texelBytes_;
  std::vector<std::byte> bytes_;
  std::vector<char> occupied_;
};
using TexelsRef = std::shared_ptr<Texels>;

/// Voxels along each axis of a mip level.
glm::ivec3 levelResolution(const glm::ivec3& finest, int level);

namespace detail {

template <class T>
T readAs(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// A row of texels as floats; components that the format does not have are 0.
using DecodeRow = void (*)(const std::byte* texels, int count, glm::vec4* values);
/// Error, naming `what`, for a format of whole numbers or of depth.
DecodeRow decoderOf(gpu::Format format, std::string_view what);

}  // namespace detail

/// A grid whose active voxels are those where any component of any of the textures (of one format and size)
/// differs from zero; `select` makes the value from their texels. So all grids that come from the same
/// textures have the same active voxels.
template <class GridType, std::size_t kCount, class Select>
typename GridType::Ptr gridOf(const std::array<TexelsRef, kCount>& sources, std::string_view what,
                              const Select& select) {
  using Node = typename GridType::TreeType::LeafNodeType;
  for (const TexelsRef& source : sources) source->load();
  const detail::DecodeRow decode = detail::decoderOf(sources[0]->format(), what);
  const LeafLayout& layout = sources[0]->layout();
  const auto occupied = [&](std::size_t leaf) {
    return std::any_of(sources.begin(), sources.end(),
                       [&](const TexelsRef& source) { return source->occupied(leaf); });
  };
  const auto fill = [&](std::size_t leaf, Node& node) {
    std::array<std::array<glm::vec4, kLeaf>, kCount> rows;
    forEachVoxel<Node>(layout, leaf, [&](const glm::ivec3& voxel, openvdb::Index offset) {
      const auto inRow = static_cast<std::size_t>(voxel.x % kLeaf);
      if (inRow == 0)
        for (std::size_t i = 0; i < kCount; ++i)
          decode(sources[i]->at(voxel), std::min(kLeaf, layout.resolution.x - voxel.x), rows[i].data());
      std::array<glm::vec4, kCount> texels;
      bool active = false;
      for (std::size_t i = 0; i < kCount; ++i) {
        texels[i] = rows[i][inRow];
        active = active || texels[i] != glm::vec4(0.0f);
      }
      if (active) node.setValueOn(offset, select(texels));
    });
  };
  return sparseGrid<GridType>(layout, what, occupied, fill);
}

}  // namespace lumivox::vdb
