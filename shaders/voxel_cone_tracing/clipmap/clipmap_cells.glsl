// Cells of 4 x 4 x 4 voxels of a clipmap's levels whose voxelization differs from the last frame: one word per cell, 0 if nothing differs.
// The levels follow each other; cells count from the first voxel of the level.
// C++ side: RadianceClipmap::Change in techniques/voxel_cone_tracing/clipmap/radiance_clipmap.h.
#ifndef LUMIVOX_CLIPMAP_CELLS
#define LUMIVOX_CLIPMAP_CELLS

#ifdef CELLS_BUILD
#define CELLS_ACCESS
#else
#define CELLS_ACCESS readonly
#endif
layout(std430, binding = 15) CELLS_ACCESS buffer ClipmapCells { uint clipmapCells[]; };

int cellsAlong(int resolution) { return (resolution + 3) >> 2; }
// Index of the cell at an offset, in voxels, from the first voxel of the level.
uint cellIndex(int level, ivec3 fromFirst, int resolution) {
  int along = cellsAlong(resolution);
  ivec3 cell = fromFirst >> 2;
  return uint(((level * along + cell.z) * along + cell.y) * along + cell.x);
}

#endif
