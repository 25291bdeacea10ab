// In which cells of 4 x 4 x 4 voxels of the levels of a clipmap what is voxelized differs from the frame before: a word for each cell, 0 where
// nothing does, level after level, counted from the first voxel of the level.
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
// By the distance from the first voxel of the level.
uint cellIndex(int level, ivec3 fromFirst, int resolution) {
  int along = cellsAlong(resolution);
  ivec3 cell = fromFirst >> 2;
  return uint(((level * along + cell.z) * along + cell.y) * along + cell.x);
}

#endif
