#version 450
// Arguments of the indirect dispatches over the bricks that each depth took from the counter (Listing 4.21). If there is too little room,
// the tree stays empty, and the host reads the wanted sizes after the frame.
#define OCTREE_BUILD
layout(local_size_x = 16) in;
#include "octree_levels.glsl"

layout(std140, binding = 0) uniform Room { uint roomBricks, roomTiles, roomLeaves; };

void main() {
  int depth = int(gl_GlobalInvocationID.x);
  if (depth > octreeDepth) return;
  uint leaves = wantedBricks - octreeLevels[octreeDepth].firstBrick;
  bool fits = wantedBricks <= roomBricks && wantedTiles <= roomTiles && leaves <= roomLeaves;
  uint end = depth < octreeDepth ? octreeLevels[depth + 1].firstBrick : wantedBricks;
  uint bricks = fits ? end - octreeLevels[depth].firstBrick : 0u;
  octreeLevels[depth].bricks = bricks;
  if (depth == octreeDepth) wantedLeaves = leaves;
  for (int kind = 0; kind < kThreads.length(); ++kind) {
    uvec2 groups = rowsOfGroups((bricks * kThreads[kind] + kOctreeGroup - 1u) / kOctreeGroup);
    octreeLevels[depth].groups[3 * kind] = groups.x;
    octreeLevels[depth].groups[3 * kind + 1] = groups.y;
    octreeLevels[depth].groups[3 * kind + 2] = 1u;
  }
}
