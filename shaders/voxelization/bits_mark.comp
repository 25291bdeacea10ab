#version 450
// The voxels of a list of fragments.
#include "common/voxel.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Count { uint fragmentCount; };
layout(std430, binding = 1) readonly buffer Fragments { VoxelFragment fragments[]; };
layout(binding = 0, r32ui) uniform uimage3D words;

void main() {
  uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (index >= fragmentCount) return;
  ivec3 voxel = unpackVoxel(fragments[index].voxel);
  imageAtomicOr(words, ivec3(voxel.xy, voxel.z >> 5), 1u << (voxel.z & 31));
}
