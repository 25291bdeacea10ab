// A whole program: turns a number of items into the arguments of a dispatch over them, so that no pass waits for the count to travel to the
// host. Items beyond the room are cut off; the wanted number is kept, and the host reads it after the frame. C++ side: finishCount() in
// framework/include/lumivox/toolkit/voxel_slots.h.
layout(local_size_x = 1) in;
#include "common/list.glsl"

layout(std430, binding = 0) buffer Count {
  uint itemCount;
  uint groupsX, groupsY, groupsZ;
  uint wanted;
};
layout(std140, binding = 0) uniform FinishCount {
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
