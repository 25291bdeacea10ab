#version 450
// Copies the fragments of another list to the front of this list.
#include "fragment_list.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std430, binding = 0) readonly buffer BaseCount { uint baseCount; };
layout(std430, binding = 1) readonly buffer BaseFragments { VoxelFragment baseFragments[]; };

void main() {
  uint index = listIndex();
  if (index == 0u) fragmentCount = baseCount;
  if (index < baseCount) fragments[index] = baseFragments[index];
}
