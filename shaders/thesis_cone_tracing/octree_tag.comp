#version 450
// Tags the nodes of one depth that are to be subdivided: each fragment descends from the root to its nodes (Listings 4.17 and 4.19).
#define OCTREE_BUILD
layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "octree.glsl"
#include "octree_extent.glsl"

layout(std140, binding = 0) uniform Tag { int depth; };

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  ivec3 first, last;
  nodesWith(unpackVoxel(fragments[index].voxel), depth, first, last);
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        uint node = nodeAt(ivec3(x, y, z), depth);
        if (node == kNone) continue;  // too little room
        // All invocations write the same values. neighbourX stores the node's position until the neighbours are known.
        octreeNodes[node].children = kTagged;
        octreeNodes[node].neighbourX = packVoxel(ivec3(x, y, z));
      }
}
