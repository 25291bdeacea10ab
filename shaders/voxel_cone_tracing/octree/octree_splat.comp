#version 450
// Adds photons to the leaves that they lie in, the sum of all, or the averages of one light after another; what other bricks hold stays as it
// is. Or what they relight (octree_relight.comp) in place of what was there, in the corners of the leaves and spread from them as the colours
// are (octree_resolve.comp).
layout(local_size_x = 64) in;
#include "octree_photons.glsl"
#include "common/integer_mean.glsl"

const int kSum = 0, kAverage = 1, kRelit = 2;
layout(constant_id = 0) const int rule = kSum;

layout(std140, binding = 0) uniform Splat {
  float unit;     // W/(sr m^2) that the value 1 of the pool stands for
  float largest;  // value that the pool can hold
};
layout(std430, binding = 4) readonly buffer Sums { PhotonSums sums[]; };
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // for the first light another one

vec3 relitVoxel(uint first, ivec3 vertex) {
  vec3 value = vec3(0.0);
  ivec3 low = max(vertex - 1, 0), high = min(vertex, 1), count = high - low + 1;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        PhotonSums sum = sums[first + uint(x | y << 1 | z << 2)];
        value += meanOf(sum.red, sum.green, sum.blue) * (uintBitsToFloat(sum.brightest) / unit);
      }
  return value / float(count.x * count.y * count.z);
}

void main() {
  uint brick, lane;
  if (!itemOf(octreeDepth + 1, voxelsOfBrick(), brick, lane)) return;
  ivec3 voxel = voxelOfLane(lane), texel = texelOf(brick) + voxel;
  vec4 value = texelFetch(pool, texel, 0);
  bool isLeaf = brick >= octreeLevels[octreeDepth].firstBrick;
  uint first = 8u * (brick - octreeLevels[octreeDepth].firstBrick);
  if (rule == kRelit && isLeaf) value.rgb = relitVoxel(first, voxel);
  if (rule != kRelit && isLeaf && all(lessThan(voxel, ivec3(2)))) {
    PhotonSums sum = sums[first + uint(voxel.x | voxel.y << 1 | voxel.z << 2)];
    // Pre-multiplied by the opacity of the surfaces.
    float mean = rule == kSum ? kFixedPoint / float(max(sum.photons, 1u)) : float(max(sum.weight, 1u));
    value.rgb += vec3(sum.red, sum.green, sum.blue) / mean * (value.a * uintBitsToFloat(sum.brightest) / unit);
  }
  // A voxel may meet more surface than one plane has in it, and so more flux than the unit of half floats is made for.
  imageStore(poolImage, texel, vec4(min(value.rgb, largest), value.a));
}
