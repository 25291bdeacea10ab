// Where the light or the fragments of voxels may differ from those of static geometry as it was lit once: a bit for each cell of voxels,
// and for what lies above the cells. What has not changed need not be lit, averaged or filtered again.
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

// Of a node by its place along the curve of its depth.
bool isChanged(uint morton, int depth) {
  morton >>= 3 * max(depth - cellDepth, 0);
  return (changedCells[firstWord(min(depth, cellDepth)) + (morton >> 5)] >> (morton & 31u) & 1u) != 0u;
}
// The cell that a voxel lies in, along the curve.
uint cellOf(ivec3 voxel) { return mortonOf(voxel) >> 3 * (voxelDepth - cellDepth); }

#ifdef CHANGES_BUILD
// A cell, and all that it lies in.
void setChanged(uint morton) {
  for (int depth = cellDepth; depth >= 0; --depth, morton >>= 3) {
    uint word = firstWord(depth) + (morton >> 5), bit = 1u << (morton & 31u);
    if ((changedCells[word] & bit) == 0u) atomicOr(changedCells[word], bit);
  }
}
#endif
#endif
