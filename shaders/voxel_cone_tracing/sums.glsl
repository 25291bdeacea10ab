// Where the sums of an occupied voxel lie: in the dense grid's bricks of 4 x 4 x 4 voxels (`bricks` and `brickCount` are declared before), or
// eight for each leaf of an octree, those of the voxels that are its own. The levels of a clipmap lie side by side in one grid. Included
// after the local size, which is along x alone.
#pragma lumivox axis PLACES grid octree clipmap
#pragma lumivox require !CHANGED || PLACES != clipmap
#include "toolkit/taken_fragments.glsl"
#if PLACES == PLACES_OCTREE
#include "octree/octree_levels.glsl"
#include "octree/octree_ranks.glsl"

uint sumsAt(ivec3 voxel) {
  uint brick = rankedBrick(mortonOf(voxel >> 1), octreeDepth);
  if (brick == kNone || octreeLevels[octreeDepth].bricks == 0u) return 0u;  // there was too little room, and the frame is not shown
  ivec3 own = voxel & 1;
  return 8u * (brick - octreeLevels[octreeDepth].firstBrick) + uint(own.x | own.y << 1 | own.z << 2);
}
#else
uint sumsAt(ivec3 voxel) { return sumsOf(bricks[brickOf(voxel, brickCount)], bitOf(voxel)); }
#endif
