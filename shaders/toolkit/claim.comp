#version 450
// Counts the fragments of each voxel; the first fragment of a voxel claims its slot. Until number.comp, the volume holds these counts.
// C++ side: claimSlots() in framework/include/lumivox/toolkit/voxel_slots.h.
layout(local_size_x = 64) in;
#include "common/fragments.glsl"

layout(std430, binding = 2) buffer SlotCount { uint slotCount; };
layout(std430, binding = 3) writeonly buffer SlotVoxels { uint slotVoxels[]; };
layout(binding = 0, r32ui) uniform uimage3D slots;

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  uint voxel = fragments[index].voxel;
  if (imageAtomicAdd(slots, unpackVoxel(voxel), 1u) == 0u) slotVoxels[atomicAdd(slotCount, 1u)] = voxel;
}
