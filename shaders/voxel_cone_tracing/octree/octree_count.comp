#version 450
// Counts the tagged nodes, and the tiles with one or the nodes that are shown, in chunks of words.
#include "octree_tags.glsl"
layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 0) uniform Words {
  int words;
  int own;  // 1: nodes that are shown are counted, 0: tiles
};
layout(std430, binding = 2) readonly buffer Tags { uint tags[]; };
layout(std430, binding = 3) readonly buffer Shown { uint shown[]; };
layout(std430, binding = 4) writeonly buffer ChunkCounts { uvec2 chunkCounts[]; };

void main() {
  uint chunk = listIndex(), first = kChunk * chunk;
  if (first >= uint(words)) return;
  uvec2 count = uvec2(0u);
  for (uint word = first; word < min(first + kChunk, uint(words)); ++word)
    count += uvec2(bitCount(tags[word]), bitCount(own != 0 ? shown[word] : tilesIn(tags[word])));
  chunkCounts[chunk] = count;
}
