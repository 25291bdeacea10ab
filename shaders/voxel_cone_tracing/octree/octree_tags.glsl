// Tags are one bit per possible node (toolkit/bit_tree.glsl), set if the node exists: so all nodes are
// counted and allocated before any is written.
#ifndef LUMIVOX_OCTREE_TAGS
#define LUMIVOX_OCTREE_TAGS
#include "toolkit/bit_tree.glsl"

// Number of words of tags that one invocation counts.
const uint kChunk = 64u;

#endif
