// The bricks of an octree by their depths, for passes over them. Included after the local size of kOctreeGroup, which is along x alone.
// C++ side: VoxelOctree in techniques/voxel_cone_tracing/octree/radiance_octree.h, forEachBrick in octree.h.
#ifndef LUMIVOX_OCTREE_LEVELS
#define LUMIVOX_OCTREE_LEVELS
#include "common/voxel.glsl"
#include "common/list.glsl"
#include "octree.glsl"

const uint kOctreeGroup = 64u;
// So many threads a brick have dispatches of their own.
const uint kThreads[2] = uint[2](1u, kBrickVoxels);

struct OctreeLevel {
  uint firstBrick, bricks;
  uint groups[6];  // x, y, z of dispatches, in the order of kThreads
};

layout(std430, binding = 10) OCTREE_ACCESS buffer OctreeLevels {
  uint wantedBricks, wantedShown;  // all that the fragments ask for, whether there is room or not
  uint wantedLeaves;               // bricks of the finest level
  OctreeLevel octreeLevels[];      // by depth; and one behind for all depths together
};
// Of each brick, by depth, the place of its node, in nodes of its depth, 10 bits an axis.
layout(std430, binding = 11) OCTREE_ACCESS buffer OctreeBricks { uint octreeBricks[]; };

// The brick of this thread at a depth, and which of its brick's threads it is; false behind the last.
bool itemOf(int depth, uint threads, out uint brick, out uint lane) {
  uint item = listIndex();
  brick = octreeLevels[depth].firstBrick + item / threads;
  lane = item % threads;
  return item / threads < octreeLevels[depth].bricks;
}

ivec3 voxelOfLane(uint lane) { return ivec3(lane & 1u, lane >> 1 & 1u, lane >> 2); }

#endif
