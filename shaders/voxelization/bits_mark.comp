#version 450
// The voxels of a list of fragments. Of fragments that cover a part of their voxel each is judged by itself, by one rule for all of a voxel:
// the one that covers most decides, and a wall keeps its voxels beside a lattice.

layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "masks.glsl"

layout(binding = 0, r32ui) uniform uimage3D words;

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  if (isSet(voxel, unpackHalf2x16(fragment.albedoBCoverage).y))
    imageAtomicOr(words, ivec3(voxel.xy, voxel.z >> 5), 1u << (voxel.z & 31));
}
