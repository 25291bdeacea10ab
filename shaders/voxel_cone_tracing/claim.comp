#version 450
// Lists the occupied bricks, and gives each the places for the sums of its occupied voxels. The order is that of the threads: no result
// depends on it.
#include "common/voxel.glsl"
#include "bricks.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(std140, binding = 0) uniform Size { ivec3 brickCount; };
layout(std430, binding = 3) buffer Bricks { Brick bricks[]; };
layout(std430, binding = 5) writeonly buffer BrickList { uint brickList[]; };
layout(std430, binding = 6) buffer BrickTotals {
  uint listed;  // bricks
  uint claimed; // voxels
};

void main() {
  ivec3 place = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(place, brickCount))) return;
  uint index = brickOf(4 * place, brickCount);
  uint voxels = uint(bitCount(bricks[index].low) + bitCount(bricks[index].high));
  if (voxels == 0u) return;
  bricks[index].first = atomicAdd(claimed, voxels);
  brickList[atomicAdd(listed, 1u)] = packVoxel(place);
}
