// Bricks of nodes: a node's brick is the number of tagged nodes before it, found in two reads at any depth.
#ifndef LUMIVOX_OCTREE_RANKS
#define LUMIVOX_OCTREE_RANKS
#include "octree.glsl"
#include "toolkit/bit_tree.glsl"

layout(std430, binding = 12) readonly buffer OctreeRanks { RankedTags octreeRanks[]; };

// The brick of a node, given by its place along the curve of its depth; kNone: no such node.
uint rankedBrick(uint morton, int depth) {
  return rankIn(octreeRanks[firstWord(depth) + (morton >> 5)], morton);
}

#endif
