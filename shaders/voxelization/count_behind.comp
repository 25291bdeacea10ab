#version 450
// How many items lie behind the first ones, as the arguments of a dispatch over them (finish.comp).
layout(local_size_x = 1) in;
#include "common/list.glsl"

layout(std430, binding = 0) readonly buffer First { uint firstItems; };
layout(std430, binding = 1) readonly buffer Count { uint itemCount; };  // of all, those that there is no room for too
layout(std430, binding = 2) writeonly buffer Behind {
  uint itemsBehind;
  uint groupsX, groupsY, groupsZ;
};
layout(std140, binding = 0) uniform Parameters {
  int capacity;
  int workGroupSize;
};

void main() {
  uint items = min(itemCount, uint(capacity)) - firstItems;
  uvec2 groups = rowsOfGroups((items + uint(workGroupSize) - 1u) / uint(workGroupSize));
  itemsBehind = items;
  groupsX = groups.x;
  groupsY = groups.y;
  groupsZ = 1u;
}
