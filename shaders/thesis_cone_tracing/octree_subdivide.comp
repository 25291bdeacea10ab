#version 450
// Allocates a brick and, above the leaves, eight children for each tagged node of a depth, by atomic counters (Listing 4.22).
#define OCTREE_BUILD
layout(local_size_x = 64) in;
#include "octree_levels.glsl"

layout(std140, binding = 0) uniform Subdivision {
  int depth;
  uint roomBricks, roomTiles;
};
layout(std430, binding = 4) readonly buffer NodeRange {
  uint firstNode, endNode;
  uint groups[3];
};

void main() {
  uint node = firstNode + listIndex();
  if (node >= endNode || octreeNodes[node].children != kTagged) return;
  uint brick = atomicAdd(wantedBricks, 1u);
  octreeNodes[node].children = kNone;
  if (brick < roomBricks) {
    octreeNodes[node].brick = brick;
    octreeBricks[brick] = OctreeBrick(node, octreeNodes[node].neighbourX);
  }
  if (depth == octreeDepth) return;
  uint tile = atomicAdd(wantedTiles, 1u);
  if (tile < roomTiles) octreeNodes[node].children = 8u * tile;
}
