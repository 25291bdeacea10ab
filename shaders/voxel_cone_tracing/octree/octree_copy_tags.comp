#version 450
// Copies the tags of static geometry, to which those of moving geometry are added.
#include "toolkit/bit_tree.glsl"
layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 0) uniform Words { int words; };
layout(std430, binding = 0) readonly buffer StillTags { uint stillTags[]; };
layout(std430, binding = 1) readonly buffer StillShown { uint stillShown[]; };
layout(std430, binding = 2) writeonly buffer Tags { uint tags[]; };
layout(std430, binding = 3) writeonly buffer Shown { uint shown[]; };

void main() {
  uint word = listIndex();
  if (word >= uint(words)) return;
  tags[word] = stillTags[word];
  shown[word] = stillShown[word];
}
