// Tags are a bit for each node that could be (toolkit/bit_tree.glsl), set where there is one: so all nodes are counted, and room is made for
// them, before any is written.
#ifndef LUMIVOX_OCTREE_TAGS
#define LUMIVOX_OCTREE_TAGS
#include "toolkit/bit_tree.glsl"

// Words of tags that one thread counts.
const uint kChunk = 64u;

#endif
