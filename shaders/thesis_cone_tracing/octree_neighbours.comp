#version 450
// Finds the neighbours of the nodes of one depth: each fragment moves from its node by the node's width along each axis and descends from
// the root to the node there (Listing 4.18).
#define OCTREE_BUILD
layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "octree.glsl"
#include "octree_extent.glsl"

layout(std140, binding = 0) uniform Depth { int depth; };

uint neighbour(ivec3 place) {
  if (any(greaterThanEqual(place, ivec3(1 << depth)))) return kNone;
  uint node = nodeAt(place, depth);
  return node != kNone && octreeNodes[node].brick != kNone ? node : kNone;
}

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  ivec3 first, last;
  nodesWith(unpackVoxel(fragments[index].voxel), depth, first, last);
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        uint node = nodeAt(ivec3(x, y, z), depth);
        if (node == kNone || octreeNodes[node].brick == kNone) continue;
        // All invocations write the same values.
        octreeNodes[node].neighbourX = neighbour(ivec3(x + 1, y, z));
        octreeNodes[node].neighbourY = neighbour(ivec3(x, y + 1, z));
        octreeNodes[node].neighbourZ = neighbour(ivec3(x, y, z + 1));
      }
}
