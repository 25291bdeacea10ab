// Bricks of nodes by counting: a node's brick is the number of nodes that are tagged before it, in two reads whatever its depth.
#ifndef LUMIVOX_OCTREE_RANKS
#define LUMIVOX_OCTREE_RANKS
#include "octree.glsl"
#include "toolkit/bit_tree.glsl"

layout(std430, binding = 12) readonly buffer OctreeRanks { RankedTags octreeRanks[]; };

// Of a node by its place along the curve of its depth; kNone: there is none.
uint rankedBrick(uint morton, int depth) {
  return rankIn(octreeRanks[firstWord(depth) + (morton >> 5)], morton);
}

#endif
