#version 450
// Turns the number of fragments into the arguments of a dispatch over them, so that the count never travels to the host.
layout(local_size_x = 1) in;

layout(std430, binding = 0) buffer Count {
  uint fragmentCount;
  uint groupsX, groupsY, groupsZ;
};
layout(std140, binding = 0) uniform Parameters {
  int capacity;
  int workGroupSize;
};

const uint kMostGroups = 65535u;  // that OpenGL guarantees per axis

void main() {
  fragmentCount = min(fragmentCount, uint(capacity));
  uint groups = (fragmentCount + uint(workGroupSize) - 1u) / uint(workGroupSize);
  groupsX = min(max(groups, 1u), kMostGroups);
  groupsY = max((groups + kMostGroups - 1u) / kMostGroups, 1u);
  groupsZ = 1u;
}
