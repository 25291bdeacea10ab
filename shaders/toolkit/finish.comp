#version 450
// Turns a number of items into the arguments of a dispatch over them, so that no pass waits for the count to travel to the host. What there
// was no room for is cut off; how many were wanted is kept, for the host to look at when the frame is done.
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
