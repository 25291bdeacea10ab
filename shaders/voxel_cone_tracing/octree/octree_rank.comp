#version 450
// Writes the number of tagged nodes, and of shown nodes, before each word of tags. No node is shown if there is too little room for the
// bricks around the shown nodes, which octree_nodes.comp then does not write.
#include "octree_tags.glsl"
layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 0) uniform RankRoom {
  uint roomBricks, roomShown;
  uint words;
};
layout(std430, binding = 2) readonly buffer Tags { uint tags[]; };
layout(std430, binding = 3) readonly buffer Shown { uint shown[]; };
layout(std430, binding = 4) readonly buffer ChunkCounts { uvec2 chunkCounts[]; };  // before each
layout(std430, binding = 5) writeonly buffer ShownRanks { RankedTags shownRanks[]; };
layout(std430, binding = 10) readonly buffer OctreeLevels { uint wantedBricks, wantedShown; };
layout(std430, binding = 12) writeonly buffer OctreeRanks { RankedTags octreeRanks[]; };

void main() {
  uint chunk = listIndex(), first = kChunk * chunk;
  if (first >= words) return;
  bool fits = wantedBricks <= roomBricks && wantedShown <= roomShown;
  uvec2 before = chunkCounts[chunk];
  for (uint word = first; word < min(first + kChunk, words); ++word) {
    uvec2 bits = uvec2(tags[word], shown[word]);
    octreeRanks[word] = RankedTags(bits.x, before.x);
    shownRanks[word] = RankedTags(fits ? bits.y : 0u, before.y);
    before += uvec2(bitCount(bits.x), bitCount(bits.y));
  }
}
