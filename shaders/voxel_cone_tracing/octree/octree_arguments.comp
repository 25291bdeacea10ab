#version 450
// The bricks of each depth, and the dispatches over them, so that no count travels to the host. Where there is too little room the tree stays
// empty; the host learns how much is wanted when the frame is done.
#define OCTREE_BUILD
#include "toolkit/bit_tree.glsl"
layout(local_size_x = 16) in;
#include "octree_levels.glsl"

layout(std140, binding = 0) uniform Room { uint roomBricks, roomShown, roomLeaves; };
layout(std430, binding = 12) readonly buffer OctreeRanks { RankedTags octreeRanks[]; };
uint firstBrickOf(int depth) { return octreeRanks[firstWord(depth)].nodesBefore; }

void main() {
  int depth = int(gl_GlobalInvocationID.x);  // one more: all of them
  if (depth > octreeDepth + 1) return;
  uint first = depth <= octreeDepth ? firstBrickOf(depth) : 0u;
  uint end = depth < octreeDepth ? firstBrickOf(depth + 1) : wantedBricks;
  uint leaves = wantedBricks - firstBrickOf(octreeDepth);
  bool fits = wantedBricks <= roomBricks && wantedShown <= roomShown && leaves <= roomLeaves;
  uint bricks = fits ? end - first : 0u;
  octreeLevels[depth].firstBrick = first;
  octreeLevels[depth].bricks = bricks;
  if (depth == octreeDepth) wantedLeaves = end - first;
  for (int kind = 0; kind < kThreads.length(); ++kind) {
    uvec2 groups = rowsOfGroups((bricks * kThreads[kind] + kOctreeGroup - 1u) / kOctreeGroup);
    octreeLevels[depth].groups[3 * kind] = groups.x;
    octreeLevels[depth].groups[3 * kind + 1] = groups.y;
    octreeLevels[depth].groups[3 * kind + 2] = 1u;
  }
}
