#version 450
// The number of items after the first ones, and the arguments of an indirect dispatch over them (finish.comp).
layout(local_size_x = 1) in;
#include "common/list.glsl"

layout(std430, binding = 0) readonly buffer First { uint firstItems; };
layout(std430, binding = 1) readonly buffer Count { uint itemCount; };  // all items, including those beyond the capacity
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
