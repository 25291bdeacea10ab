// A bit for each node that could be, set where there is one: so all nodes are counted, and room is made for them, before any is written.
#ifndef LUMIVOX_OCTREE_TAGS
#define LUMIVOX_OCTREE_TAGS
#include "toolkit/bit_tree.glsl"

const uint kNone = 0xffffffffu;
// Words of tags that one thread counts.
const uint kChunk = 64u;

uint below(uint bits, uint place) { return bits & ((1u << place) - 1u); }

// Tags beside the number of nodes before them, which is that of the first one's brick.
struct RankedTags {
  uint tags;
  uint nodesBefore;
};

// The number of tagged nodes before one by its place along the curve; kNone: it has no tag.
uint rankIn(RankedTags word, uint morton) {
  uint bit = morton & 31u;
  return (word.tags >> bit & 1u) == 0u ? kNone : word.nodesBefore + uint(bitCount(below(word.tags, bit)));
}

#endif
