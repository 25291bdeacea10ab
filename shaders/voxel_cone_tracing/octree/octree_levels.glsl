// The bricks of an octree by depth, for passes over them. Included after the local size of kOctreeGroup, which is along x only.
// C++ side: VoxelOctree in techniques/voxel_cone_tracing/octree/radiance_octree.h, forEachBrick in octree.h.
#ifndef LUMIVOX_OCTREE_LEVELS
#define LUMIVOX_OCTREE_LEVELS
#include "common/voxel.glsl"
#include "common/list.glsl"
#include "octree.glsl"

const uint kOctreeGroup = 64u;
// Numbers of threads per brick for which dispatch arguments exist.
const uint kThreads[2] = uint[2](1u, kBrickVoxels);

struct OctreeLevel {
  uint firstBrick, bricks;
  uint groups[6];  // x, y, z of dispatches, in the order of kThreads
};

layout(std430, binding = 10) OCTREE_ACCESS buffer OctreeLevels {
  uint wantedBricks, wantedShown;  // needed by the fragments, even if there is too little room
  uint wantedLeaves;               // bricks of the finest level
  OctreeLevel octreeLevels[];      // by depth, then one entry for all depths together
};
// For each brick, ordered by depth, the position of its node in nodes of its depth, 10 bits per axis.
layout(std430, binding = 11) OCTREE_ACCESS buffer OctreeBricks { uint octreeBricks[]; };

// The brick of this invocation at a depth, and the number of the invocation within the brick; false past the last brick.
bool itemOf(int depth, uint threads, out uint brick, out uint lane) {
  uint item = listIndex();
  brick = octreeLevels[depth].firstBrick + item / threads;
  lane = item % threads;
  return item / threads < octreeLevels[depth].bricks;
}

ivec3 voxelOfLane(uint lane) { return ivec3(lane & 1u, lane >> 1 & 1u, lane >> 2); }

#endif
