#version 450
// Turns a number of items into the arguments of a dispatch over them, so that no pass waits for the count to travel to the host. What there
// was no room for is cut off; how many were wanted is kept, for the host to look at when the frame is done.
layout(local_size_x = 1) in;

layout(std430, binding = 0) buffer Count {
  uint itemCount;
  uint groupsX, groupsY, groupsZ;
  uint wanted;
};
layout(std140, binding = 0) uniform Parameters {
  int capacity;
  int workGroupSize;
};

const uint kMostGroups = 65535u;  // that OpenGL guarantees per axis

void main() {
  wanted = itemCount;
  itemCount = min(itemCount, uint(capacity));
  uint groups = (itemCount + uint(workGroupSize) - 1u) / uint(workGroupSize);
  groupsX = min(max(groups, 1u), kMostGroups);
  groupsY = max((groups + kMostGroups - 1u) / kMostGroups, 1u);
  groupsZ = 1u;
}
