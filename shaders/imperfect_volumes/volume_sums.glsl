// Means over the fragments of a voxel, independent of their order (common/integer_mean.glsl), for the voxel's harmonics: half the sum of
// the radiances of a fragment's two sides, and their difference times the normal, in units of the brightest radiance in the voxel.
#include "common/integer_mean.glsl"

struct SlotSums {
  uint coverage;
  uint both[3];        // per channel
  int difference[9];   // per channel: x, y, z
};
layout(std430, binding = 5) buffer Sums { SlotSums sums[]; };
