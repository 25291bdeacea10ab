#version 450
// One level of six directional grids, one invocation per voxel.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#include "mipmap_directional.glsl"

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (all(lessThan(cell, coarse))) mipmapCell(cell);
}
