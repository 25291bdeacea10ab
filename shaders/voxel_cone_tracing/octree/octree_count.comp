#version 450
// Counts the tagged nodes and the shown nodes in chunks of words.
#include "octree_tags.glsl"
layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 0) uniform Words { int words; };
layout(std430, binding = 2) readonly buffer Tags { uint tags[]; };
layout(std430, binding = 3) readonly buffer Shown { uint shown[]; };
layout(std430, binding = 4) writeonly buffer ChunkCounts { uvec2 chunkCounts[]; };

void main() {
  uint chunk = listIndex(), first = kChunk * chunk;
  if (first >= uint(words)) return;
  uvec2 count = uvec2(0u);
  for (uint word = first; word < min(first + kChunk, uint(words)); ++word)
    count += uvec2(bitCount(tags[word]), bitCount(shown[word]));
  chunkCounts[chunk] = count;
}
