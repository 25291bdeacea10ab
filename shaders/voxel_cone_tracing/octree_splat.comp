#version 450
// Adds the photons of one light to the leaves that they lie in; what other bricks hold stays as it is. The light of several lights adds up,
// which an average over all their photons would not.
layout(local_size_x = 64) in;
#include "octree_photons.glsl"

layout(std140, binding = 0) uniform Splat { float unit; };  // W/(sr m^2) that the value 1 of the pool stands for
layout(std430, binding = 4) readonly buffer Sums { PhotonSums sums[]; };
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // for the first light another one

void main() {
  uint brick, lane;
  if (!itemOf(octreeDepth + 1, 27u, brick, lane)) return;
  ivec3 voxel = ivec3(lane % 3u, lane / 3u % 3u, lane / 9u), texel = texelOf(brick) + voxel;
  vec4 value = texelFetch(pool, texel, 0);
  if (brick >= octreeLevels[octreeDepth].firstBrick && all(lessThan(voxel, ivec3(2)))) {
    PhotonSums sum = sums[8u * (brick - octreeLevels[octreeDepth].firstBrick) + uint(voxel.x | voxel.y << 1 | voxel.z << 2)];
    // Pre-multiplied by the opacity of the surfaces.
    if (sum.weight > 0u)
      value.rgb += vec3(sum.red, sum.green, sum.blue) / float(sum.weight) * (value.a * uintBitsToFloat(sum.brightest) / unit);
  }
  imageStore(poolImage, texel, value);
}
