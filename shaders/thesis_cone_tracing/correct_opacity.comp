#version 450
// Listing 4.10, one invocation per voxel, with its work groups of 8 x 8 x 8.
#include "correct_opacity.glsl"
layout(local_size_x = 8, local_size_y = 8, local_size_z = 8) in;

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (all(lessThan(voxel, resolution))) correctOpacity(voxel);
}
