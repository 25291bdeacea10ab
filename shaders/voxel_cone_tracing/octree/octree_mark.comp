#version 450
// Tags the nodes of all depths that hold something: thesis 004, Sec. 4.2.2, Listing 4.19.
// Deviates: a bit a node in place of a mark in the node itself, so that no node must be there yet and all depths are done at once
// (octree_tag.comp does as published).
layout(local_size_x = 64) in;
#include "toolkit/moving_fragments.glsl"
#include "toolkit/bit_tree.glsl"
#include "octree_extent.glsl"

layout(std140, binding = 0) uniform Marks {
  int depth;   // of the leaves
  int voxels;  // where they lie
  int own;     // 1: nodes have bricks for what lies in their own voxels; 0: for all that they show
};
layout(std430, binding = 2) buffer Tags { uint tags[]; };
layout(std430, binding = 3) buffer Shown { uint shown[]; };  // the same, where nodes have bricks for all that they show

// Tags are never taken away: one that is seen need not be set again, and one that is not seen yet does no harm.
void tag(uint morton, int nodeDepth) {
  uint word = firstWord(nodeDepth) + (morton >> 5), bit = 1u << (morton & 31u);
  if ((tags[word] & bit) == 0u) atomicOr(tags[word], bit);
}
void tagShown(uint morton, int nodeDepth) {
  uint word = firstWord(nodeDepth) + (morton >> 5), bit = 1u << (morton & 31u);
  if ((shown[word] & bit) == 0u) atomicOr(shown[word], bit);
}

void main() {
  uint index;
  if (!fragmentOf(index)) return;
  ivec3 voxel = unpackVoxel(fragments[index].voxel);
  for (int nodeDepth = depth; nodeDepth >= 0; --nodeDepth) {
    ivec3 first, last;
    nodesWith(voxel, depth - nodeDepth, 1 << nodeDepth, voxels, first, last);
    if (own != 0) tag(mortonOf(last), nodeDepth);  // as in a grid
    for (int z = first.z; z <= last.z; ++z)
      for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) tagShown(mortonOf(ivec3(x, y, z)), nodeDepth);
  }
}
