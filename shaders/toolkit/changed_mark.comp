#version 450
// Marks the cells that contain moving fragments, and lists these fragments.
layout(local_size_x = 64) in;
#include "moving_fragments.glsl"
#define CHANGES_BUILD
#include "changed_cells.glsl"

layout(std430, binding = 10) buffer ChangedCount { uint changedCount; };
layout(std430, binding = 11) writeonly buffer ChangedFragments { uint changedFragments[]; };

void main() {
  uint index;
  if (!fragmentOf(index)) return;
  setChanged(cellOf(unpackVoxel(fragments[index].voxel)));
  changedFragments[atomicAdd(changedCount, 1u)] = index;
}
