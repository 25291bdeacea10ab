#version 450
// The dispatch over the changed fragments.
layout(local_size_x = 1) in;
#include "common/list.glsl"

layout(std430, binding = 10) buffer ChangedCount {
  uint changedCount;
  uint groups[3];
};

void main() {
  uvec2 rows = rowsOfGroups((changedCount + 63u) / 64u);
  groups[0] = rows.x;
  groups[1] = rows.y;
  groups[2] = 1u;
}
