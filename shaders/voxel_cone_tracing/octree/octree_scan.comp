#version 450
// From the counts of chunks how many nodes, and nodes that are shown, lie before each, and how many there are. One work group.
#define OCTREE_BUILD
layout(local_size_x = 64) in;
#include "octree_levels.glsl"

layout(std140, binding = 0) uniform Chunks { int chunks; };
layout(std430, binding = 4) buffer ChunkCounts { uvec2 chunkCounts[]; };

shared uvec2 parts[64];

void main() {
  uint thread = gl_LocalInvocationID.x, each = (uint(chunks) + 63u) / 64u;
  uint first = thread * each, last = min(first + each, uint(chunks));
  uvec2 sum = uvec2(0u);
  for (uint i = first; i < last; ++i) sum += chunkCounts[i];
  parts[thread] = sum;
  memoryBarrierShared();
  barrier();
  uvec2 before = uvec2(0u);
  for (uint i = 0u; i < thread; ++i) before += parts[i];
  if (thread == 63u) {
    wantedBricks = before.x + sum.x;
    wantedShown = before.y + sum.y;
  }
  for (uint i = first; i < last; ++i) {
    uvec2 count = chunkCounts[i];
    chunkCounts[i] = before;
    before += count;
  }
}
