// One invocation for each fragment of a list, and the slot of its voxel, for sums over the fragments of occupied voxels. Included after the
// local size, which is along x only.
// C++ side: claimSlots() and SlotBinding in framework/include/lumivox/toolkit/voxel_slots.h.
#ifndef LUMIVOX_SLOT_OF_VOXEL
#define LUMIVOX_SLOT_OF_VOXEL
#include "common/fragments.glsl"

layout(std430, binding = 4) readonly buffer FragmentsOfSlot { uint fragmentsOfSlot[]; };
layout(binding = 0, r32ui) uniform readonly uimage3D slots;

// The slot of a voxel that contains a fragment; false if there was no room for it, in which case the frame is rendered again.
bool slotOf(ivec3 voxel, out uint slot) {
  slot = imageLoad(slots, voxel).r - 1u;
  return slot < uint(fragmentsOfSlot.length());
}

#endif
