// The bricks of an octree by their depths, for passes over them (Listing 4.20). Included after the local size of kOctreeGroup, which is along x
// alone. C++ side: OctreeNodes in octree_ports.h, forEachBrick in octree.h of techniques/thesis_cone_tracing.
#ifndef LUMIVOX_THESIS_OCTREE_LEVELS
#define LUMIVOX_THESIS_OCTREE_LEVELS
#include "common/list.glsl"
#include "common/voxel.glsl"
#include "octree.glsl"

const uint kOctreeGroup = 64u;
// So many threads a brick have dispatches of their own: its centre, faces, corners, a side, edges, all.
const uint kThreads[6] = uint[6](1u, 6u, 8u, 9u, 12u, 27u);

struct OctreeBrick {
  uint node;
  uint place;  // of the node, in nodes of its depth, 10 bits an axis
};
struct OctreeLevel {
  uint firstBrick, bricks;
  uint groups[18];  // x, y, z of dispatches, in the order of kThreads
};

layout(std430, binding = 10) OCTREE_ACCESS buffer OctreeLevels {
  uint wantedBricks, wantedTiles;  // all that the fragments ask for, whether there is room or not
  uint wantedLeaves;               // bricks of the finest level
  OctreeLevel octreeLevels[];      // by depth
};
layout(std430, binding = 11) OCTREE_ACCESS buffer OctreeBricks { OctreeBrick octreeBricks[]; };  // by depth

// The brick of this thread at a depth, and which of its brick's threads it is; false behind the last.
bool itemOf(int depth, uint threads, out uint brick, out uint lane) {
  uint item = listIndex();
  brick = octreeLevels[depth].firstBrick + item / threads;
  lane = item % threads;
  return item / threads < octreeLevels[depth].bricks;
}

#endif
