#version 450
// Emission and opacity of each voxel of a field, for ray marches with interpolation (thesis 004 Sec. 2.3).
#include "toolkit/voxel_transfer.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(binding = 0, rgba32f) uniform writeonly image3D classified;

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (all(lessThan(voxel, gridResolution))) imageStore(classified, voxel, transferOf(voxel));
}
