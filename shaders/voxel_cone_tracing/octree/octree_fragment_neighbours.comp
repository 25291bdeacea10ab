#version 450
// The neighbours of the nodes of one depth as published: each fragment goes on from its node by the node's width along each axis and looks for
// what is there from the root. Thesis 004, Sec. 4.2.2, Listing 4.18.
#define OCTREE_BUILD
layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "octree.glsl"
#include "octree_extent.glsl"
#include "octree_neighbours.glsl"

layout(std140, binding = 0) uniform Depth {
  int depth;
  int voxels;  // where they lie
};

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  ivec3 first, last;
  nodesWith(unpackVoxel(fragments[index].voxel), octreeDepth - depth, 1 << depth, voxels, first, last);
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        uint node = nodeAt(ivec3(x, y, z), depth);
        // Whoever writes here writes the same.
        if (node != kNone && octreeNodes[node].brick != kNone) findNeighbours(node, ivec3(x, y, z), depth);
      }
}
