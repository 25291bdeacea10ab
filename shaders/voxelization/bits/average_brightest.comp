#version 450
// The largest emitted radiance of a component among the fragments of each voxel: the unit in which average_add.comp adds them up, so that a
// dim voxel keeps its light in a grid with a very bright one.
#include "average.glsl"
#include "toolkit/slot_of_voxel.glsl"

layout(std430, binding = 5) buffer Brightest { uint brightest[]; };  // bits of a float: for numbers from 0 on their order is that of the numbers

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  uint slot;
  if (!slotOf(unpackVoxel(fragments[index].voxel), slot)) return;
  vec3 emission = unpackShared(fragments[index].emission);
  atomicMax(brightest[slot], floatBitsToUint(max(emission.r, max(emission.g, emission.b))));
}
