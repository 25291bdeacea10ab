#version 450
// Appends the static fragments of changed cells to the list of moving fragments.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "changed_cells.glsl"

layout(std430, binding = 2) readonly buffer CellEnds { uint cellEnds[]; };
layout(std430, binding = 3) readonly buffer CellFragments { uint cellFragments[]; };
layout(std430, binding = 10) buffer ChangedCount { uint changedCount; };
layout(std430, binding = 11) writeonly buffer ChangedFragments { uint changedFragments[]; };

void main() {
  uint cell = listIndex();
  if (cell >= 1u << 3 * cellDepth || !isChanged(cell, cellDepth)) return;
  uint first = cell > 0u ? cellEnds[cell - 1u] : 0u, end = cellEnds[cell];
  if (first == end) return;
  uint place = atomicAdd(changedCount, end - first);
  for (uint i = first; i < end; ++i) changedFragments[place + i - first] = cellFragments[i];
}
