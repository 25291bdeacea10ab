// One invocation for each occupied voxel that has a slot. Included after the local size, which is along x only.
// C++ side: forEachSlot() in framework/include/lumivox/toolkit/voxel_slots.h.
#ifndef LUMIVOX_SLOTS
#define LUMIVOX_SLOTS
#include "common/list.glsl"
#include "common/voxel.glsl"

layout(std430, binding = 2) readonly buffer SlotCount { uint slotCount; };
layout(std430, binding = 3) readonly buffer SlotVoxels { uint slotVoxels[]; };
layout(std430, binding = 4) readonly buffer FragmentsOfSlot { uint fragmentsOfSlot[]; };

// The slot of this invocation and its voxel; false behind the last one.
bool slotHere(out uint slot, out ivec3 voxel) {
  slot = listIndex();
  if (slot >= slotCount) return false;
  voxel = unpackVoxel(slotVoxels[slot]);
  return true;
}

#endif
