#version 450
// How many fragments each voxel has: the denominator of the average, known before anything is added up.
#include "common/voxel.glsl"

layout(local_size_x = 64) in;

layout(std140, binding = 0) uniform Grid { ivec3 resolution; };
layout(std430, binding = 0) readonly buffer FragmentCount { uint fragmentCount; };
layout(std430, binding = 1) readonly buffer Fragments { VoxelFragment fragments[]; };
layout(std430, binding = 2) buffer Counts { uint counts[]; };

void main() {
  uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (index >= fragmentCount) return;
  ivec3 voxel = unpackVoxel(fragments[index].voxel);
  atomicAdd(counts[(voxel.z * resolution.y + voxel.y) * resolution.x + voxel.x], 1u);
}
