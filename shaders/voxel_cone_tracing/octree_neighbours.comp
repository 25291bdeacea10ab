#version 450
// The neighbours of each node: thesis 004, Sec. 4.2.2, Listing 4.18.
// Deviates: one thread a node, after the whole tree is there, in place of one a fragment at every depth.
#define OCTREE_BUILD
layout(local_size_x = 64) in;
#include "octree_levels.glsl"

uint neighbour(ivec3 place, int depth) {
  if (any(greaterThanEqual(place, ivec3(1 << depth)))) return kNone;
  uint node = nodeAt(place, depth);
  return node != kNone && octreeNodes[node].brick != kNone ? node : kNone;
}

void main() {
  uint brick = listIndex();
  if (brick >= octreeLevels[octreeDepth + 1].bricks) return;
  int depth = octreeDepth;
  while (octreeLevels[depth].firstBrick > brick) --depth;
  uint node = octreeBricks[brick].node;
  ivec3 place = unpackVoxel(octreeBricks[brick].place);
  octreeNodes[node].neighbourX = neighbour(place + ivec3(1, 0, 0), depth);
  octreeNodes[node].neighbourY = neighbour(place + ivec3(0, 1, 0), depth);
  octreeNodes[node].neighbourZ = neighbour(place + ivec3(0, 0, 1), depth);
}
