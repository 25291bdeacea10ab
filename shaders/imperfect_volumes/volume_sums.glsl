// Means over the fragments of a voxel, independent of their order (common/integer_mean.glsl), of which its harmonics are made: half the sum
// of what both sides of a fragment send, and their difference times its normal, in units of the brightest of the voxel.
#include "common/integer_mean.glsl"

struct SlotSums {
  uint coverage;
  uint both[3];        // of each channel
  int difference[9];   // of each channel: x, y, z
};
layout(std430, binding = 5) buffer Sums { SlotSums sums[]; };
