// Bricks of nodes by counting: a node's brick is the number of nodes that are tagged before it, in two reads whatever its depth.
#ifndef LUMIVOX_OCTREE_RANKS
#define LUMIVOX_OCTREE_RANKS
#include "octree.glsl"
#include "octree_tags.glsl"

layout(std430, binding = 12) readonly buffer OctreeRanks { RankedTags octreeRanks[]; };

// Of a node by its place along the curve of its depth; kNone: there is none.
uint rankedBrick(uint morton, int depth) {
  RankedTags word = octreeRanks[firstWord(depth) + (morton >> 5)];
  uint bit = morton & 31u;
  return (word.tags >> bit & 1u) == 0u ? kNone : word.nodesBefore + uint(bitCount(below(word.tags, bit)));
}

#endif
