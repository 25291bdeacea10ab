#version 450
// Sets the range of nodes of the next depth: all nodes after those of the previous depths (Listing 4.21). Their bricks begin at the current
// value of the counter.
#define OCTREE_BUILD
layout(local_size_x = 1) in;
#include "octree_levels.glsl"

layout(std140, binding = 0) uniform Range {
  int depth;
  uint roomTiles;
};
layout(std430, binding = 4) buffer NodeRange {
  uint firstNode, endNode;
  uint groups[3];
};

void main() {
  firstNode = endNode;
  endNode = 8u * min(wantedTiles, roomTiles);
  uvec2 rows = rowsOfGroups((endNode - firstNode + kOctreeGroup - 1u) / kOctreeGroup);
  groups[0] = rows.x;
  groups[1] = rows.y;
  groups[2] = 1u;
  octreeLevels[depth].firstBrick = wantedBricks;
}
