// One bit for each possible node of an octree over a grid: depth d, with the root at depth 0, has 8^d bits along a Morton curve, and the
// depths follow each other. RankedTags add the number of bits set before them, so that a node finds its
// place in a list of nodes in one read.
// C++ side: framework/include/lumivox/toolkit/bit_tree.h.
#ifndef LUMIVOX_BIT_TREE
#define LUMIVOX_BIT_TREE

// The first word of a depth d, whose 8^d bits take at least one word:
//   1 + 1 + sum over k from 2 to d - 1 of 2^(3k - 5) = 2 + 2 (8^(d - 2) - 1) / 7,
// where (8^n - 1) / 7 has every third of 3n bits set.
uint firstWord(int depth) { return depth < 2 ? uint(depth) : 2u + 2u * (0x09249249u & ((1u << 3 * (depth - 2)) - 1u)); }

uint spreadBits(uint x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}
uint gatherBits(uint x) {
  x &= 0x09249249u;
  x = (x | x >> 2) & 0x030c30c3u;
  x = (x | x >> 4) & 0x0300f00fu;
  x = (x | x >> 8) & 0x030000ffu;
  return (x | x >> 16) & 0x3ffu;
}
uint mortonOf(ivec3 place) { return spreadBits(uint(place.x)) | spreadBits(uint(place.y)) << 1 | spreadBits(uint(place.z)) << 2; }
ivec3 placeOf(uint morton) { return ivec3(gatherBits(morton), gatherBits(morton >> 1), gatherBits(morton >> 2)); }

const uint kNone = 0xffffffffu;
uint below(uint bits, uint place) { return bits & ((1u << place) - 1u); }

// Bits of 32 nodes, and the number of tagged nodes before them.
struct RankedTags {
  uint tags;
  uint nodesBefore;
};

// The number of tagged nodes before a node, given by its place along the curve; kNone if the node has no tag.
uint rankIn(RankedTags word, uint morton) {
  uint bit = morton & 31u;
  return (word.tags >> bit & 1u) == 0u ? kNone : word.nodesBefore + uint(bitCount(below(word.tags, bit)));
}

#endif
