// Which cells of 4 x 4 x 4 voxels of the levels of a clipmap have changed while the levels stayed where they are: a word for each cell, level
// after level, counted from the first voxel of the level.
// C++ side: RadianceClipmap::Change in techniques/voxel_cone_tracing/radiance_clipmap.h.
#ifndef LUMIVOX_CLIPMAP_CELLS
#define LUMIVOX_CLIPMAP_CELLS

const uint kVoxelized = 1u;  // what was voxelized differs
const uint kRead = 2u;       // what is read does: that, or what finer levels make of it

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
