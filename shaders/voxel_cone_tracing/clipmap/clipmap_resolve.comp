#version 450
// Writes the voxels of a clipmap from the integer sums, as resolve.comp does for a dense grid.
//
// SAMPLED: opacity from the samples of a voxel's sides.
// REFLECTED: light of bounces is added to the direct light of the sums.
#pragma lumivox axis SAMPLED 0 1
#pragma lumivox require !(SAMPLED && REFLECTED)
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "common/voxel.glsl"
#include "clipmap_write.glsl"
#include "clipmap_stack.glsl"
#include "../resolved.glsl"

layout(std140, binding = 0) uniform Parameters {
  ivec3 brickCount;
  float unit;  // radiance of the value 1 of the volumes, W/(sr m^2)
};
layout(std430, binding = 0) readonly buffer BrickList { uint brickList[]; };
layout(std430, binding = 1) readonly buffer BrickCount { uint listed; };
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
layout(std430, binding = 4) readonly buffer DirectionalSums { VoxelDirections directions[]; };
#include "../face_sums.glsl"

void main() {
  uint item = listIndex();
  if (item / 64u >= listed) return;
  ivec3 voxel = voxelOf(unpackVoxel(brickList[item / 64u]), item % 64u);
  Brick brick = bricks[brickOf(voxel, brickCount)];
  if (!isOccupied(brick, item % 64u)) return;
  uint place = sumsOf(brick, item % 64u);
  vec4 faces[6];
#if SAMPLED
  for (int face = 0; face < 6; ++face) faces[face] = faceOfSamples(place, face, unit);
#else
  for (int face = 0; face < 6; ++face) faces[face] = withReflected(faceOf(place, face, false, unit), 6u * place + uint(face), unit);
#endif
  int level = levelInStack(voxel);
  writeVoxel(ownPlace(level, voxelOfLevel(voxel, level)), faces, true);
}
