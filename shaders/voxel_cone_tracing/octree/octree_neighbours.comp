#version 450
// The neighbours of each node: thesis 004, Sec. 4.2.2.
// Deviates from Listing 4.18, which octree_fragment_neighbours.comp has: one thread a node, after the whole tree is there.
#define OCTREE_BUILD
layout(local_size_x = 64) in;
#include "octree_levels.glsl"
#include "octree_neighbours.glsl"

void main() {
  uint brick = listIndex();
  if (brick >= octreeLevels[octreeDepth + 1].bricks) return;
  int depth = octreeDepth;
  while (octreeLevels[depth].firstBrick > brick) --depth;
  uint node = octreeBricks[brick].node;
  findNeighbours(node, unpackVoxel(octreeBricks[brick].place), depth);
}
