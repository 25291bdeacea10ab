#version 450
// Writes the finest level of the lobes of normals from their integer sums, for the occupied bricks.
#include "common/voxel.glsl"
#include "../bricks.glsl"
#include "common/integer_mean.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "lobes.glsl"

layout(std140, binding = 0) uniform Size { ivec3 brickCount; };
layout(std430, binding = 0) readonly buffer BrickList { uint brickList[]; };
layout(std430, binding = 1) readonly buffer BrickCount { uint listed; };
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
layout(std430, binding = 4) readonly buffer DirectionalSums { VoxelDirections directions[]; };
layout(std430, binding = 5) readonly buffer LobeSums { Lobe lobes[]; };
layout(binding = 0, rgba32f) uniform writeonly image3D lobeImage;

void main() {
  uint item = listIndex();
  if (item / 64u >= listed) return;
  ivec3 voxel = voxelOf(unpackVoxel(brickList[item / 64u]), item % 64u);
  Brick brick = bricks[brickOf(voxel, brickCount)];
  if (!isOccupied(brick, item % 64u)) return;
  uint place = sumsOf(brick, item % 64u);
  vec4 mean = vec4(lobes[place].sums[0], lobes[place].sums[1], lobes[place].sums[2], lobes[place].sums[3]) / kSignedFixedPoint;
  imageStore(lobeImage, voxel, mean * (uintBitsToFloat(directions[place].brightest) / kLobeShare));
}
