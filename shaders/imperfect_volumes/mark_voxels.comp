#version 450
// Marks the voxels that occupied voxels read for the next bounce, on both sides.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#include "mark.glsl"
#include "feeding.glsl"
layout(binding = 0) uniform sampler3D opacity;
layout(binding = 1) uniform sampler3D meanNormals;

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution)) || texelFetch(opacity, voxel, 0).r <= occupied) return;
  // Where the normals cancel out, the light decides the surface's direction, which is not known yet: all voxels around are marked.
  vec3 mean = texelFetch(meanNormals, voxel, 0).xyz;
  if (feedsOwn != 0) {
    imageStore(marks, voxel, uvec4(1u));
  } else if (dot(mean, mean) > kLeastNormal * kLeastNormal) {
    markReads(vec3(voxel) + 0.5, normalize(mean));
    markReads(vec3(voxel) + 0.5, -normalize(mean));
  } else {
    int most = int(shift) + 2, side = 2 * most + 1;
    for (int i = 0; i < side * side * side; ++i)
      imageStore(marks, inVolume(voxel + ivec3(i % side, i / side % side, i / (side * side)) - most), uvec4(1u));
  }
}
