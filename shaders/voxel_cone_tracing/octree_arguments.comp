#version 450
// The bricks of each depth, and the dispatches over them, so that no count travels to the host. Where there is too little room the tree stays
// empty; the host learns how much is wanted when the frame is done.
#define OCTREE_BUILD
#include "octree_tags.glsl"
layout(local_size_x = 16) in;
#include "octree_levels.glsl"

layout(std140, binding = 0) uniform Room { uint roomBricks, roomTiles; };
layout(std430, binding = 5) readonly buffer Ranks { uvec2 ranks[]; };

void main() {
  int depth = int(gl_GlobalInvocationID.x);  // one more: all of them
  if (depth > octreeDepth + 1) return;
  uint first = depth <= octreeDepth ? ranks[firstWord(depth)].x : 0u;
  uint end = depth < octreeDepth ? ranks[firstWord(depth + 1)].x : wantedBricks;
  uint bricks = wantedBricks <= roomBricks && wantedTiles <= roomTiles ? end - first : 0u;
  octreeLevels[depth].firstBrick = first;
  octreeLevels[depth].bricks = bricks;
  for (int kind = 0; kind < kThreads.length(); ++kind) {
    uvec2 groups = rowsOfGroups((bricks * kThreads[kind] + kOctreeGroup - 1u) / kOctreeGroup);
    octreeLevels[depth].groups[3 * kind] = groups.x;
    octreeLevels[depth].groups[3 * kind + 1] = groups.y;
    octreeLevels[depth].groups[3 * kind + 2] = 1u;
  }
}
