// A list of the occupied bricks of 4 x 4 x 4 cells, which later passes process with one work group per brick. The marking pass counts the
// bricks; the count is the number of groups of indirect dispatches, without a read-back. The list has no order; no result depends on it.
#include "common/voxel.glsl"

layout(std430, binding = 4) buffer BrickList {
  uint brickGroups[3];  // the number of bricks, 1, 1
  uint brickPlaces[];
};

#ifdef MARKS_BRICKS
layout(std430, binding = 7) buffer BrickFlags { uint brickFlags[]; };  // 1: listed

void markBrick(ivec3 cell, ivec3 cells) {
  ivec3 brick = cell >> 2, bricks = (cells + 3) >> 2;
  if (atomicExchange(brickFlags[(brick.z * bricks.y + brick.y) * bricks.x + brick.x], 1u) == 0u)
    brickPlaces[atomicAdd(brickGroups[0], 1u)] = packVoxel(brick);
}
#else
// The cell of this invocation in a listed brick; it may lie outside the grid.
ivec3 listedCell() { return 4 * unpackVoxel(brickPlaces[gl_WorkGroupID.x]) + ivec3(gl_LocalInvocationID); }
#endif
