#version 450
// Finds the normals about which the fragments of a voxel are grouped, SECOND after first.
#pragma lumivox axis SECOND 0 1
layout(local_size_x = 64) in;
#include "planes.glsl"

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  uint slot;
  if (!slotOf(unpackVoxel(fragment.voxel), slot)) return;
#if SECOND
  uint key = secondKeyOf(fragment, planeKeys[2u * slot]);
  if (key != 0u) atomicMax(planeKeys[2u * slot + 1u], key);
#else
  atomicMax(planeKeys[2u * slot], firstKeyOf(fragment));
#endif
}
