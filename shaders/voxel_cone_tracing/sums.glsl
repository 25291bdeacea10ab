// The place of an occupied voxel's sums. A dense grid has bricks of 4 x 4 x 4 voxels (including files first declare `bricks` and
// `brickCount`). An octree has eight sums per leaf, for the voxels of the leaf itself. The levels of a clipmap lie side by side in one
// dense grid. Included after the local size, which is along x only.
#pragma lumivox axis PLACES grid octree clipmap
#include "toolkit/taken_fragments.glsl"
#if PLACES == PLACES_OCTREE
#include "octree/octree_levels.glsl"
#include "octree/octree_ranks.glsl"

uint sumsAt(ivec3 voxel) {
  uint brick = rankedBrick(mortonOf(voxel >> 1), octreeDepth);
  if (brick == kNone || octreeLevels[octreeDepth].bricks == 0u) return 0u;  // too little room: the frame is rendered again
  ivec3 own = voxel & 1;
  return 8u * (brick - octreeLevels[octreeDepth].firstBrick) + uint(own.x | own.y << 1 | own.z << 2);
}
#else
uint sumsAt(ivec3 voxel) { return sumsOf(bricks[brickOf(voxel, brickCount)], bitOf(voxel)); }
#endif
