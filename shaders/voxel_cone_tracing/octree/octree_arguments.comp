#version 450
// Writes the range of bricks of each depth and the arguments of indirect dispatches over them, without a read-back. If there is too little
// room, the tree stays empty, and the host reads the wanted sizes after the frame.
#define OCTREE_BUILD
#include "toolkit/bit_tree.glsl"
layout(local_size_x = 16) in;
#include "octree_levels.glsl"

layout(std140, binding = 0) uniform Room { uint roomBricks, roomShown, roomLeaves; };
layout(std430, binding = 12) readonly buffer OctreeRanks { RankedTags octreeRanks[]; };
uint firstBrickOf(int depth) { return octreeRanks[firstWord(depth)].nodesBefore; }

void main() {
  int depth = int(gl_GlobalInvocationID.x);  // octreeDepth + 1: all depths together
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
