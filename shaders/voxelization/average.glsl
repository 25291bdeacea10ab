// Averages over the fragments of each voxel, which do not depend on their order. Every occupied voxel has a slot of sums; a volume holds first
// the number of fragments of a voxel and then the number of its slot, from 1 on, so that the sums need room for occupied voxels alone.
#include "common/voxel.glsl"

layout(local_size_x = 64) in;

uint itemIndex() {
  return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

// Like kFixedPoint, for shares of either sign.
const float kSignedFixedPoint = 1073741824.0;  // 2^30

// What a fragment of coverage 1 adds to the sum of coverages of a voxel with so many.
uint fullShare(uint fragments) { return uint(kFixedPoint / float(fragments) + 0.5); }

#ifdef AVERAGING
layout(std140, binding = 0) uniform Averaging {
  ivec3 resolution;
  int coverageSum;  // 1: the coverages of a voxel add up, to 1 at most; 0: their mean
};
#endif
