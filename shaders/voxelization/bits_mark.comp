#version 450
// The voxels of a list of fragments.

layout(local_size_x = 64) in;
#include "common/fragments.glsl"

layout(binding = 0, r32ui) uniform uimage3D words;

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  ivec3 voxel = unpackVoxel(fragments[index].voxel);
  imageAtomicOr(words, ivec3(voxel.xy, voxel.z >> 5), 1u << (voxel.z & 31));
}
