#version 450
// Tags the nodes of all depths that hold something: thesis 004, Sec. 4.2.2, Listing 4.19.
// Deviates: a bit a node in place of a mark in the node itself, so that no node must be there yet and all depths are done at once.
layout(local_size_x = 64) in;
#include "toolkit/moving_fragments.glsl"
#include "toolkit/bit_tree.glsl"

layout(std140, binding = 0) uniform Marks {
  int depth;  // of the leaves
};
layout(std430, binding = 2) buffer Tags { uint tags[]; };    // nodes that have a brick: something lies in their own voxels
layout(std430, binding = 3) buffer Shown { uint shown[]; };  // nodes in which reading between voxels finds something

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
    // Voxel j is read in the nodes ceil(j / 2) - 1 and floor(j / 2), which are one for odd j.
    ivec3 coarse = voxel >> depth - nodeDepth, first = max(coarse - 1 >> 1, 0), last = coarse >> 1;
    tag(mortonOf(last), nodeDepth);
    for (int z = first.z; z <= last.z; ++z)
      for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) tagShown(mortonOf(ivec3(x, y, z)), nodeDepth);
  }
}
