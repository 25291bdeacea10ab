// What several fragments or photons of one leaf voxel come to, as means of integers that do not depend on their order. Deviates from Listing
// 4.9, whose average in 8 bits does (inject.comp).
#include "common/integer_mean.glsl"

struct VoxelSums {
  uint items;
  uint brightest;  // bits of a float: for numbers from 0 on their order is that of the numbers
  uint red, green, blue, coverage;  // shares of averages, in units of kFixedPoint
};
layout(std430, binding = 4) buffer Sums { VoxelSums sums[]; };  // eight for each leaf

// Two passes: how many there are and the brightest of them, then their shares.
const int kCount = 0, kAdd = 1;
layout(constant_id = 0) const int stage = kCount;

// Where the sums of a voxel of a leaf lie, by the brick's number and by which of its eight it is.
uint sumsOf(uint brick, uint own) { return 8u * (brick - octreeLevels[octreeDepth].firstBrick) + own; }

// Of a value in the first pass.
void countIn(uint place, vec3 value) {
  atomicAdd(sums[place].items, 1u);
  atomicMax(sums[place].brightest, floatBitsToUint(max(value.r, max(value.g, value.b))));
}

// A value in units of the brightest; 1 in its last component.
vec4 unitsOf(uint place, vec3 value) {
  float brightest = uintBitsToFloat(sums[place].brightest);
  return vec4(brightest > 0.0 ? min(value / brightest, 1.0) : vec3(0.0), 1.0);
}

// Of a value in the second pass, its share of the mean.
void addTo(uint place, vec4 share) {
  uvec4 addend = shareOf(share);
  atomicAdd(sums[place].red, addend.r);
  atomicAdd(sums[place].green, addend.g);
  atomicAdd(sums[place].blue, addend.b);
  atomicAdd(sums[place].coverage, addend.a);
}
