#version 450
// How many nodes and tiles lie before those of each word of tags.
#include "octree_tags.glsl"
layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 0) uniform Words { int words; };
layout(std430, binding = 2) readonly buffer Tags { uint tags[]; };
layout(std430, binding = 4) readonly buffer ChunkCounts { uvec2 chunkCounts[]; };  // before each
layout(std430, binding = 5) writeonly buffer TilesBefore { uint tilesBefore[]; };
layout(std430, binding = 12) writeonly buffer OctreeRanks { RankedTags octreeRanks[]; };

void main() {
  uint chunk = listIndex(), first = kChunk * chunk;
  if (first >= uint(words)) return;
  uvec2 before = chunkCounts[chunk];
  for (uint word = first; word < min(first + kChunk, uint(words)); ++word) {
    octreeRanks[word] = RankedTags(tags[word], before.x);
    tilesBefore[word] = before.y;
    before += uvec2(bitCount(tags[word]), bitCount(tilesIn(tags[word])));
  }
}
