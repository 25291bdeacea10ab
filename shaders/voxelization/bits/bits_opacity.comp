#version 450
// Writes bits as opacities 0 and 1.
#include "bits.glsl"

layout(local_size_x = 32, local_size_y = 2) in;  // rows of a volume are contiguous in memory

layout(binding = 2, r8) uniform writeonly image3D opacity;

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, imageSize(opacity)))) return;
  uint bit = wordAt(ivec3(voxel.xy, voxel.z >> 5)) >> (voxel.z & 31) & 1u;
  imageStore(opacity, voxel, vec4(float(bit)));
}
