#version 450
// Adds photons to the leaves that they lie in, the sum of all, or the averages of one light after another; what other bricks hold stays as it
// is.
layout(local_size_x = 64) in;
#include "octree_photons.glsl"
#include "common/integer_mean.glsl"

const int kSum = 0, kAverage = 1;
layout(constant_id = 0) const int rule = kSum;

layout(std140, binding = 0) uniform Splat {
  float unit;     // W/(sr m^2) that the value 1 of the pool stands for
  float largest;  // value that the pool can hold
};
layout(std430, binding = 4) readonly buffer Sums { PhotonSums sums[]; };
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // for the first light another one

void main() {
  uint brick, lane;
  if (!itemOf(octreeDepth + 1, kBrickVoxels, brick, lane)) return;
  ivec3 texel = texelOf(brick) + voxelOfLane(lane);
  vec4 value = texelFetch(pool, texel, 0);
  if (brick >= octreeLevels[octreeDepth].firstBrick) {
    PhotonSums sum = sums[kBrickVoxels * (brick - octreeLevels[octreeDepth].firstBrick) + lane];
    // Pre-multiplied by the opacity of the surfaces.
    float mean = rule == kSum ? kFixedPoint / float(max(sum.photons, 1u)) : float(max(sum.weight, 1u));
    value.rgb += vec3(sum.red, sum.green, sum.blue) / mean * (value.a * uintBitsToFloat(sum.brightest) / unit);
  }
  // A voxel may meet more surface than one plane has in it, and so more flux than the unit of half floats is made for.
  imageStore(poolImage, texel, vec4(min(value.rgb, largest), value.a));
}
