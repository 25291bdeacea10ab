#version 450
// Lists the fragments that gather light in this frame: those of voxels that have their turn, and of voxels of which nothing is known from
// before. The order depends on the threads; no result depends on it.
layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "turns.glsl"

layout(std430, binding = 6) buffer ListedCount { uint listedCount; };
layout(std430, binding = 7) writeonly buffer ListedFragments { uint listedFragments[]; };

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  ivec3 voxel = unpackVoxel(fragments[index].voxel);
  uint first;
  if (hasTurn(voxel) || !isKnown(voxel, first)) listedFragments[atomicAdd(listedCount, 1u)] = index;
}
