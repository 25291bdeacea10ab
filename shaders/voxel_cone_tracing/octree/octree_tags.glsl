// Tags are a bit for each node that could be (toolkit/bit_tree.glsl), set where there is one: so all nodes are counted, and room is made
// for them, before any is written. A tile of eight nodes is a byte.
#ifndef LUMIVOX_OCTREE_TAGS
#define LUMIVOX_OCTREE_TAGS
#include "toolkit/bit_tree.glsl"

// Words of tags that one thread counts.
const uint kChunk = 64u;

// The lowest bit of each byte that is not 0.
uint tilesIn(uint word) {
  word |= word >> 4;
  word |= word >> 2;
  return (word | word >> 1) & 0x01010101u;
}

#endif
