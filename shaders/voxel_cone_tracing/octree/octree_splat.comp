#version 450
// Adds the light of the photons to the leaves that contain them: the sum of all photons, or the averages of one light after another. All
// other bricks are copied.
layout(local_size_x = 64) in;
#include "octree_photons.glsl"
#include "common/integer_mean.glsl"

const int kSum = 0, kAverage = 1;
layout(constant_id = 0) const int rule = kSum;

layout(std140, binding = 0) uniform Splat {
  float unit;     // radiance of the value 1 of the pool, W/(sr m^2)
  float largest;  // largest value that the pool can hold
};
layout(std430, binding = 4) readonly buffer Sums { PhotonSums sums[]; };
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // for the first light another texture

void main() {
  uint brick, lane;
  if (!itemOf(octreeDepth + 1, kBrickVoxels, brick, lane)) return;
  ivec3 texel = texelOf(brick) + voxelOfLane(lane);
  vec4 value = texelFetch(pool, texel, 0);
  if (brick >= octreeLevels[octreeDepth].firstBrick) {
    PhotonSums sum = sums[kBrickVoxels * (brick - octreeLevels[octreeDepth].firstBrick) + lane];
    // Radiance is pre-multiplied by the opacity of the surfaces.
    float mean = rule == kSum ? kFixedPoint / float(max(sum.photons, 1u)) : float(max(sum.weight, 1u));
    value.rgb += vec3(sum.red, sum.green, sum.blue) / mean * (value.a * uintBitsToFloat(sum.brightest) / unit);
  }
  // A voxel may contain more surface than one plane, and so reflect more flux than the unit of half floats allows for.
  imageStore(poolImage, texel, vec4(min(value.rgb, largest), value.a));
}
