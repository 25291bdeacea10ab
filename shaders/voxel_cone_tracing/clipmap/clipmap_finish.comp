#version 450
// Turns the number of fragments into the arguments of a dispatch over them, as the port VoxelFragments has them. What there was no room for
// is cut off; how many were wanted is kept, for the host to look at when the frame is done.
layout(local_size_x = 1) in;
#include "common/list.glsl"

layout(std430, binding = 7) buffer Count {
  uint fragmentCount;
  uint groupsX, groupsY, groupsZ;
  uint wanted;
};
layout(std140, binding = 0) uniform Room {
  uint capacity;
  uint workGroupSize;
};

void main() {
  wanted = fragmentCount;
  fragmentCount = min(fragmentCount, capacity);
  uvec2 groups = rowsOfGroups((fragmentCount + workGroupSize - 1u) / workGroupSize);
  groupsX = groups.x;
  groupsY = groups.y;
  groupsZ = 1u;
}
