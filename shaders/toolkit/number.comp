#version 450
// Moves the number of fragments of each voxel from the volume to the slot, and stores the slot's number plus 1 in the volume.
// C++ side: claimSlots() in framework/include/lumivox/toolkit/voxel_slots.h.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "common/voxel.glsl"

layout(std430, binding = 2) readonly buffer SlotCount { uint slotCount; };
layout(std430, binding = 3) readonly buffer SlotVoxels { uint slotVoxels[]; };
layout(std430, binding = 4) writeonly buffer FragmentsOfSlot { uint fragmentsOfSlot[]; };
layout(binding = 0, r32ui) uniform uimage3D slots;

void main() {
  uint slot = listIndex();
  if (slot >= slotCount) return;
  ivec3 voxel = unpackVoxel(slotVoxels[slot]);
  fragmentsOfSlot[slot] = imageLoad(slots, voxel).r;
  imageStore(slots, voxel, uvec4(slot + 1u));
}
