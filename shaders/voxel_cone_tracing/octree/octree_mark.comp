#version 450
// Tags the occupied nodes of all depths: thesis 004, Sec. 4.2.2, Listing 4.19.
// Deviates: one bit per node instead of a mark in the node itself, so that no node must exist yet and all depths are tagged at once.
layout(local_size_x = 64) in;
#include "toolkit/moving_fragments.glsl"
#include "toolkit/bit_tree.glsl"

layout(std140, binding = 0) uniform Marks {
  int depth;  // of the leaves
};
layout(std430, binding = 2) buffer Tags { uint tags[]; };    // nodes that have a brick: one of their own voxels is occupied
layout(std430, binding = 3) buffer Shown { uint shown[]; };  // nodes whose trilinear reads find an occupied voxel

// Tags are never cleared: a visible tag need not be set again, and a tag that is set but not yet visible is only set twice.
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
    // Trilinear reads of voxel j begin in the nodes ceil(j / 2) - 1 and floor(j / 2), which are the same node for odd j.
    ivec3 coarse = voxel >> depth - nodeDepth, first = max(coarse - 1 >> 1, 0), last = coarse >> 1;
    tag(mortonOf(last), nodeDepth);
    for (int z = first.z; z <= last.z; ++z)
      for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) tagShown(mortonOf(ivec3(x, y, z)), nodeDepth);
  }
}
