#version 450
// The largest component of emitted radiance among the fragments of each voxel: the unit of the sums of average_add.comp, so that a dim
// voxel keeps its light in a grid with a very bright one.
#include "average.glsl"
#include "toolkit/slot_of_voxel.glsl"

layout(std430, binding = 5) buffer Brightest { uint brightest[]; };  // bits of a non-negative float, which order like the float

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  uint slot;
  if (!slotOf(unpackVoxel(fragments[index].voxel), slot)) return;
  vec3 emission = emissionOf(fragments[index]);
  atomicMax(brightest[slot], floatBitsToUint(max(emission.r, max(emission.g, emission.b))));
}
