#version 450
// The average of what the fragments of a voxel reflect.
// Deviates from thesis 004 Listing 4.9: its running average in 8 bits depends on the order of the writes and overflows past 255 fragments.
// Here each fragment adds its share of the average as an integer, and integer sums do not depend on the order:
//   sum over fragments of round(value / brightest * 2^31 / n),  0 <= value <= brightest,  so that the sum fits into 32 bits for any n.
// The unit is the voxel's own, so that a dark room beside a very bright one in the same grid keeps its light.
#include "common/voxel.glsl"
#include "bricks.glsl"

layout(local_size_x = 64) in;

layout(std140, binding = 0) uniform Size { ivec3 brickCount; };
layout(std430, binding = 0) readonly buffer FragmentCount { uint fragmentCount; };
layout(std430, binding = 1) readonly buffer Fragments { VoxelFragment fragments[]; };
layout(std430, binding = 2) readonly buffer Radiances { float radiances[]; };  // three of each fragment, W/(sr m^2)
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
layout(std430, binding = 4) buffer Sums { VoxelSums sums[]; };

void main() {
  uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  uint place = sumsOf(bricks[brickOf(voxel, brickCount)], bitOf(voxel));
  float coverage = clamp(unpackHalf2x16(fragment.albedoBCoverage).y, 0.0, 1.0);
  float unit = uintBitsToFloat(sums[place].brightest);
  vec3 radiance = vec3(radiances[3 * index], radiances[3 * index + 1], radiances[3 * index + 2]);
  vec3 part = unit > 0.0 ? min(radiance / unit, 1.0) : vec3(0.0);
  float share = kFixedPoint / float(max(sums[place].fragments, 1u));
  uvec4 addend = uvec4(vec4(part, 1.0) * (coverage * share) + 0.5);
  if (addend.r != 0u) atomicAdd(sums[place].red, addend.r);
  if (addend.g != 0u) atomicAdd(sums[place].green, addend.g);
  if (addend.b != 0u) atomicAdd(sums[place].blue, addend.b);
  atomicAdd(sums[place].coverage, addend.a);
}
