#version 450
// Marks the voxels of a list's items in a volume, by one bit each or by the number of items. Items outside the grid mark nothing.
// C++ side: VoxelField in framework/include/lumivox/toolkit/voxel_view.h.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "common/voxel.glsl"

layout(std430, binding = 0) readonly buffer ItemCount { uint itemCount; };
layout(std430, binding = 1) readonly buffer Items { uint itemWords[]; };
layout(std140, binding = 0) uniform Marking {
  uint capacity;   // of the list
  uint itemLength; // of an item in words; its first word is the voxel
  int countsItems;
};
layout(binding = 0, r32ui) uniform uimage3D marks;

void main() {
  uint item = listIndex();
  if (item >= min(itemCount, capacity)) return;
  ivec3 voxel = unpackVoxel(itemWords[item * itemLength]);
  if (countsItems != 0) imageAtomicAdd(marks, voxel, 1u);
  else imageAtomicOr(marks, ivec3(voxel.xy, voxel.z / 32), 1u << (voxel.z % 32));
}
