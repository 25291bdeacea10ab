#version 450
// Turns a number of items into the arguments of an indirect dispatch over them, so that no pass waits for a read-back. The number is
// limited to the capacity; the wanted number is kept for the host to check after the frame.
// C++ side: finishCount() in framework/include/lumivox/toolkit/counts.h.
layout(local_size_x = 1) in;
#include "common/list.glsl"

layout(std430, binding = 0) buffer Count {
  uint itemCount;
  uint groupsX, groupsY, groupsZ;
  uint wanted;
};
layout(std140, binding = 0) uniform Finish {
  int capacity;
  int workGroupSize;
};

void main() {
  wanted = itemCount;
  itemCount = min(itemCount, uint(capacity));
  uvec2 groups = rowsOfGroups((itemCount + uint(workGroupSize) - 1u) / uint(workGroupSize));
  groupsX = groups.x;
  groupsY = groups.y;
  groupsZ = 1u;
}
