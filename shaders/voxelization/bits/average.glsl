// Averages over the fragments of each voxel, which do not depend on their order. Every occupied voxel has a slot of sums.
#include "common/integer_mean.glsl"

layout(local_size_x = 64) in;

// The share that a fragment of coverage 1 adds to the sum of coverages of a voxel with so many.
uint fullShare(uint fragments) { return shareOf(1.0 / float(fragments)); }

#ifdef AVERAGING
layout(std140, binding = 0) uniform Averaging {
  ivec3 resolution;
  int coverageSum;  // 1: the coverages of a voxel add up, to 1 at most; 0: their mean
};
#endif
