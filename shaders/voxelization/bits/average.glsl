// Averages over the fragments of each voxel, independent of their order. Every occupied voxel has a slot of sums.
#include "common/integer_mean.glsl"

layout(local_size_x = 64) in;

// The amount that a fragment of coverage 1 adds to the coverage sum of a voxel with this many fragments.
uint fullShare(uint fragments) { return shareOf(1.0 / float(fragments)); }

#ifdef AVERAGING
layout(std140, binding = 0) uniform Averaging {
  ivec3 resolution;
  int coverageSum;  // opacity of a voxel: 1: the sum of its coverages, at most 1; 0: their mean
};
#endif
