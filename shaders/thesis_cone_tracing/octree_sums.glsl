// Averages of the fragments or photons of a leaf voxel, as integer means that do not depend on their order. Deviates from Listing 4.9,
// whose average in 8 bits depends on the order (inject.comp).
#include "common/integer_mean.glsl"

struct VoxelSums {
  uint items;
  uint brightest;  // bits of a non-negative float, which order like the float
  uint red, green, blue, coverage;  // shares of averages, in units of kFixedPoint
};
layout(std430, binding = 4) buffer Sums { VoxelSums sums[]; };  // eight for each leaf

// Two passes: the first counts the items and finds the brightest, the second adds their shares.
const int kCount = 0, kAdd = 1;
layout(constant_id = 0) const int stage = kCount;

// The place of the sums of a leaf's voxel: `own` is the number of the voxel, of eight, in the brick.
uint sumsOf(uint brick, uint own) { return 8u * (brick - octreeLevels[octreeDepth].firstBrick) + own; }

// First pass: counts a value.
void countIn(uint place, vec3 value) {
  atomicAdd(sums[place].items, 1u);
  atomicMax(sums[place].brightest, floatBitsToUint(max(value.r, max(value.g, value.b))));
}

// A value in units of the brightest; w is 1.
vec4 unitsOf(uint place, vec3 value) {
  float brightest = uintBitsToFloat(sums[place].brightest);
  return vec4(brightest > 0.0 ? min(value / brightest, 1.0) : vec3(0.0), 1.0);
}

// Second pass: adds a value's share of the mean.
void addTo(uint place, vec4 share) {
  uvec4 addend = shareOf(share);
  atomicAdd(sums[place].red, addend.r);
  atomicAdd(sums[place].green, addend.g);
  atomicAdd(sums[place].blue, addend.b);
  atomicAdd(sums[place].coverage, addend.a);
}
