// The bricks of an octree by depth, for passes over them (Listing 4.20). Included after the local size, kOctreeGroup along x only.
// C++ side: OctreeNodes in octree_ports.h, forEachBrick in octree.h of techniques/thesis_cone_tracing.
#ifndef LUMIVOX_THESIS_OCTREE_LEVELS
#define LUMIVOX_THESIS_OCTREE_LEVELS
#include "common/list.glsl"
#include "common/voxel.glsl"
#include "octree.glsl"

const uint kOctreeGroup = 64u;
// Numbers of threads per brick for which dispatch arguments exist: one per centre, face, corner, voxel of a side, edge, and voxel.
const uint kThreads[6] = uint[6](1u, 6u, 8u, 9u, 12u, 27u);

struct OctreeBrick {
  uint node;
  uint place;  // position of the node, in nodes of its depth, 10 bits per axis
};
struct OctreeLevel {
  uint firstBrick, bricks;
  uint groups[18];  // x, y, z of dispatches, in the order of kThreads
};

layout(std430, binding = 10) OCTREE_ACCESS buffer OctreeLevels {
  uint wantedBricks, wantedTiles;  // needed by the fragments, even if there is too little room
  uint wantedLeaves;               // bricks of the finest level
  OctreeLevel octreeLevels[];      // by depth
};
layout(std430, binding = 11) OCTREE_ACCESS buffer OctreeBricks { OctreeBrick octreeBricks[]; };  // by depth

// The brick of this invocation at a depth, and the number of the invocation within the brick; false past the last brick.
bool itemOf(int depth, uint threads, out uint brick, out uint lane) {
  uint item = listIndex();
  brick = octreeLevels[depth].firstBrick + item / threads;
  lane = item % threads;
  return item / threads < octreeLevels[depth].bricks;
}

#endif
