// Converts dense voxels to sparse OpenVDB trees, leaf by leaf and in parallel.
#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string_view>
#include <type_traits>
#include <vector>

#include "lumivox/base/file.h"

namespace lumivox::vdb {

/// Voxels along each side of a leaf node of the standard trees.
inline constexpr int kLeaf = 8;

/// Divides a grid of voxels into leaves; leaf (0,0,0) starts at voxel (0,0,0). Leaves at the far border may
/// reach beyond the grid.
struct LeafLayout {
  glm::ivec3 resolution{0}, leaves{0};

  explicit LeafLayout(const glm::ivec3& voxels)
      : resolution(voxels), leaves((voxels + (kLeaf - 1)) / kLeaf) {}
  std::size_t count() const {
    return static_cast<std::size_t>(leaves.x) * static_cast<std::size_t>(leaves.y) *
           static_cast<std::size_t>(leaves.z);
  }
  glm::ivec3 low(std::size_t leaf) const {
    const auto x = static_cast<std::size_t>(leaves.x), y = static_cast<std::size_t>(leaves.y);
    return kLeaf * glm::ivec3(static_cast<int>(leaf % x), static_cast<int>(leaf / x % y),
                              static_cast<int>(leaf / (x * y)));
  }
  /// The end of its voxels inside the grid, exclusive.
  glm::ivec3 high(std::size_t leaf) const { return glm::min(low(leaf) + kLeaf, resolution); }
};

/// Calls `work(voxel, offset of the voxel in its leaf)` for the voxels of a leaf that lie inside the grid.
template <class LeafType, class Work>
void forEachVoxel(const LeafLayout& layout, std::size_t leaf, Work&& work) {
  static_assert(LeafType::DIM == kLeaf);
  const glm::ivec3 low = layout.low(leaf), high = layout.high(leaf);
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x)
        work(glm::ivec3(x, y, z), LeafType::coordToOffset(openvdb::Coord(x, y, z)));
}

/// Makes a grid of background zero. `occupied(leaf)` must be true for every leaf with active voxels, and may
/// be true for others. `fill(leaf, node)` sets the active voxels of a node whose voxels are inactive and
/// zero. Both are called from several threads. A constant leaf becomes a tile. Error if the nodes do not fit
/// into memory.
template <class GridType, class Occupied, class Fill>
typename GridType::Ptr sparseGrid(const LeafLayout& layout, std::string_view what, const Occupied& occupied,
                                  const Fill& fill) {
  using Node = typename GridType::TreeType::LeafNodeType;
  using Value = typename GridType::ValueType;
  std::vector<std::size_t> kept;
  for (std::size_t leaf = 0; leaf < layout.count(); ++leaf)
    if (occupied(leaf)) kept.push_back(leaf);
  // Nodes of bool keep their values inside themselves, as bits.
  constexpr std::size_t kValueBytes = std::is_same_v<Value, bool> ? 0 : Node::SIZE * sizeof(Value);
  requireMemory(kept.size() * (sizeof(Node) + kValueBytes), what);

  std::vector<std::unique_ptr<Node>> nodes(kept.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, kept.size(), 16), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const glm::ivec3 low = layout.low(kept[i]);
      auto node = std::make_unique<Node>(openvdb::Coord(low.x, low.y, low.z), openvdb::zeroVal<Value>());
      fill(kept[i], *node);
      if (!node->getValueMask().isOff()) nodes[i] = std::move(node);
    }
  });

  auto grid = GridType::create(openvdb::zeroVal<Value>());
  bool tiles = false;
  for (std::unique_ptr<Node>& node : nodes) {
    if (!node) continue;
    Value value = openvdb::zeroVal<Value>();
    bool active = false;
    if (node->isConstant(value, active)) {
      grid->tree().addTile(1, node->origin(), value, active);
      node.reset();
      tiles = true;
    } else {
      grid->tree().addLeaf(node.release());
    }
  }
  if (tiles) openvdb::tools::pruneTiles(grid->tree());
  return grid;
}

}  // namespace lumivox::vdb
