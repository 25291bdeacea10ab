#version 450
// Lists the marked voxels, in no order.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#include "common/voxel.glsl"
#include "volume.glsl"
layout(binding = 0, r32ui) uniform readonly uimage3D marks;
layout(std430, binding = 0) buffer ListCount { uint listed; };
layout(std430, binding = 1) writeonly buffer List { uint list[]; };

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution)) || imageLoad(marks, voxel).r == 0u) return;
  list[atomicAdd(listed, 1u)] = packVoxel(voxel);
}
