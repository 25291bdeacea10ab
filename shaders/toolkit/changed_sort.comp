#version 450
// Sorts the static fragments by cell, so that the fragments of a cell are found without a search: `count` counts them; `fill` places each
// behind those of the preceding cells. The order within a cell depends on the threads; no result depends on it.
#pragma lumivox axis STAGE count fill
layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "changed_cells.glsl"

layout(std430, binding = 2) buffer CellEnds { uint cellEnds[]; };  // counts; after `fill`, the end of each cell's fragments
layout(std430, binding = 3) writeonly buffer CellFragments { uint cellFragments[]; };

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  uint place = atomicAdd(cellEnds[cellOf(unpackVoxel(fragments[index].voxel))], 1u);
#if STAGE == STAGE_FILL
  cellFragments[place] = index;
#endif
}
