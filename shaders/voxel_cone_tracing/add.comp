#version 450
// The average of what the fragments of a voxel reflect.
// Deviates from thesis 004 Listing 4.9: its running average in 8 bits depends on the order of the writes and overflows past 255 fragments.
// Here each fragment adds its share of a mean of integers, in units of the brightest fragment of its voxel (common/integer_mean.glsl).
#include "bricks.glsl"
#include "common/integer_mean.glsl"

layout(local_size_x = 64) in;
#include "common/fragments.glsl"

layout(std140, binding = 0) uniform Size { ivec3 brickCount; };
layout(std430, binding = 2) readonly buffer Radiances { float radiances[]; };  // three of each fragment, W/(sr m^2)
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
layout(std430, binding = 4) buffer Sums { VoxelSums sums[]; };

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  uint place = sumsOf(bricks[brickOf(voxel, brickCount)], bitOf(voxel));
  float coverage = clamp(unpackHalf2x16(fragment.albedoBCoverage).y, 0.0, 1.0);
  float unit = uintBitsToFloat(sums[place].brightest);
  vec3 radiance = vec3(radiances[3 * index], radiances[3 * index + 1], radiances[3 * index + 2]);
  vec3 part = unit > 0.0 ? min(radiance / unit, 1.0) : vec3(0.0);
  uvec4 addend = shareOf(vec4(part, 1.0) * (coverage * (1.0 / float(max(sums[place].fragments, 1u)))));
  if (addend.r != 0u) atomicAdd(sums[place].red, addend.r);
  if (addend.g != 0u) atomicAdd(sums[place].green, addend.g);
  if (addend.b != 0u) atomicAdd(sums[place].blue, addend.b);
  atomicAdd(sums[place].coverage, addend.a);
}
