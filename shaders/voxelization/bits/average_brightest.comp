#version 450
// The largest emitted radiance of a component among the fragments of each voxel: the unit in which average_add.comp adds them up, so that a
// dim voxel keeps its light in a grid with a very bright one.
#include "average.glsl"
#include "common/fragments.glsl"

layout(std430, binding = 4) buffer Brightest { uint brightest[]; };  // bits of a float: for numbers from 0 on their order is that of the numbers
layout(binding = 0, r32ui) uniform readonly uimage3D slots;

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  vec3 emission = unpackShared(fragments[index].emission);
  uint slot = imageLoad(slots, unpackVoxel(fragments[index].voxel)).r - 1u;
  if (slot >= uint(brightest.length())) return;  // there was no room for its voxel: the frame is made anew
  atomicMax(brightest[slot], floatBitsToUint(max(emission.r, max(emission.g, emission.b))));
}
