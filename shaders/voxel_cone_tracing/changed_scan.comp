#version 450
// From the counts of cells how many fragments lie before each. One work group.
layout(local_size_x = 64) in;
#include "changed_cells.glsl"

layout(std430, binding = 2) buffer CellEnds { uint cellEnds[]; };

shared uint parts[64];

void main() {
  uint thread = gl_LocalInvocationID.x, cells = 1u << 3 * cellDepth, each = (cells + 63u) / 64u;
  uint first = thread * each, last = min(first + each, cells), sum = 0u, before = 0u;
  for (uint i = first; i < last; ++i) sum += cellEnds[i];
  parts[thread] = sum;
  memoryBarrierShared();
  barrier();
  for (uint i = 0u; i < thread; ++i) before += parts[i];
  for (uint i = first; i < last; ++i) {
    uint count = cellEnds[i];
    cellEnds[i] = before;
    before += count;
  }
}
