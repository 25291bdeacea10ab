// Lists of voxels and cells of a clipmap that need work.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lumivox/plugin/technique.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {

/// Cells of 4 x 4 x 4 voxels (clipmap_cells.glsl).
inline std::uint64_t cellsOfLevel(int resolution) {
  const std::uint64_t along = (static_cast<std::uint64_t>(resolution) + 3) / 4;
  return along * along * along;
}

/// Lists of items that need work, one after another in the same memory (clipmap_items.glsl).
struct ItemLists {
  gpu::BufferRef heads, items;

  ItemLists(PassContext& frame, std::size_t lists, std::uint64_t most) {
    const std::vector<std::array<std::uint32_t, 4>> none(lists, {0, 0, 1, 1});
    heads = frame.uploaded(none, "how many voxels of levels need work");
    items = frame.elements(shaders::voxel_cone_tracing::clipmap_anew::listItems, most,
                           "voxels of levels that need work");
  }
  shader::BindingSet bindings() const {
    return {shaders::voxel_cone_tracing::clipmap_anew::listHeads(heads),
            shaders::voxel_cone_tracing::clipmap_anew::listItems(items)};
  }
  /// Byte offset in `heads` of the dispatch arguments of a list.
  static std::uint64_t argumentsBytes(std::size_t list) {
    return list * shaders::voxel_cone_tracing::clipmap_anew::listHeads.elementBytes + sizeof(std::uint32_t);
  }
};

}  // namespace lumivox::voxel_cone_tracing
