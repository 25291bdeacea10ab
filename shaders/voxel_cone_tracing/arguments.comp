#version 450
// Turns the number of bricks into the arguments of indirect dispatches over their voxels, without a read-back.
layout(local_size_x = 1) in;
#include "common/list.glsl"

layout(std430, binding = 6) readonly buffer BrickTotals { uint listed; };
layout(std430, binding = 7) writeonly buffer BrickCount { uint brickCountAndGroups[]; };  // bricks; x, y, z of dispatches, levels 0 to 2

void main() {
  brickCountAndGroups[0] = listed;
  for (uint level = 0u; level < 3u; ++level) {
    uint threads = listed * (64u >> 3u * level);
    uvec2 groups = rowsOfGroups((threads + 63u) / 64u);
    brickCountAndGroups[1u + 3u * level] = groups.x;
    brickCountAndGroups[2u + 3u * level] = groups.y;
    brickCountAndGroups[3u + 3u * level] = 1u;
  }
}
