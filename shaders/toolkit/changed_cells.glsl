// Cells of voxels whose light or fragments may differ from the static geometry as it was lit once: one bit for each cell, and for each tree
// node above the cells. Unchanged cells need not be lit, averaged or filtered again.
// C++ side: ChangedCells in framework/include/lumivox/toolkit/change_tracking.h.
#ifndef LUMIVOX_CHANGED_CELLS
#define LUMIVOX_CHANGED_CELLS
#include "toolkit/bit_tree.glsl"

layout(std140, binding = 5) uniform Changes {
  int cellDepth;   // of cells, in a tree over the grid whose root is at depth 0
  int voxelDepth;  // of the finest voxels in that tree
};
#ifdef CHANGES_BUILD
#define CHANGES_ACCESS
#else
#define CHANGES_ACCESS readonly
#endif
layout(std430, binding = 15) CHANGES_ACCESS buffer ChangedCells { uint changedCells[]; };

// Whether a node has changed, given by its place along the curve of its depth.
bool isChanged(uint morton, int depth) {
  morton >>= 3 * max(depth - cellDepth, 0);
  return (changedCells[firstWord(min(depth, cellDepth)) + (morton >> 5)] >> (morton & 31u) & 1u) != 0u;
}
// The cell that contains a voxel: its place along the curve.
uint cellOf(ivec3 voxel) { return mortonOf(voxel) >> 3 * (voxelDepth - cellDepth); }

#ifdef CHANGES_BUILD
// Marks a cell and all nodes that contain it.
void setChanged(uint morton) {
  for (int depth = cellDepth; depth >= 0; --depth, morton >>= 3) {
    uint word = firstWord(depth) + (morton >> 5), bit = 1u << (morton & 31u);
    if ((changedCells[word] & bit) == 0u) atomicOr(changedCells[word], bit);
  }
}
#endif
#endif
