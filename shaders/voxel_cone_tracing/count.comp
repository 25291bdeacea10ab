#version 450
// How many fragments each voxel has: the denominator of the average, known before anything is added up.
#include "common/voxel.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer FragmentCount { uint fragmentCount; };
layout(std430, binding = 1) readonly buffer Fragments { VoxelFragment fragments[]; };
layout(binding = 0, r32ui) uniform uimage3D counts;

void main() {
  uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (index >= fragmentCount) return;
  imageAtomicAdd(counts, unpackVoxel(fragments[index].voxel), 1u);
}
