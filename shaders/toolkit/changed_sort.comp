#version 450
// The fragments of static geometry by their cells, so that those of a cell are found without a look at all others: counts them, and then
// gives each a place behind those of the cells before. Their order within a cell is that of the threads: no result depends on it.
#pragma lumivox axis STAGE count fill
layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "changed_cells.glsl"

layout(std430, binding = 2) buffer CellEnds { uint cellEnds[]; };  // counts; filled, the end of each cell's
layout(std430, binding = 3) writeonly buffer CellFragments { uint cellFragments[]; };

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  uint place = atomicAdd(cellEnds[cellOf(unpackVoxel(fragments[index].voxel))], 1u);
#if STAGE == STAGE_FILL
  cellFragments[place] = index;
#endif
}
