#version 450
// What each voxel reflects of the light that cones gather: the mean over its fragments where these gathered in this frame, and what it was
// in the frame before elsewhere.
//
// DIRECTIONS: a mean per face of the voxel, with the weights of its direct light.
#pragma lumivox axis DIRECTIONS 0 1
layout(local_size_x = 64) in;
#include "common/voxel.glsl"
#include "common/list.glsl"
#include "turns.glsl"
#if !TREE
layout(std430, binding = 0) readonly buffer BrickList { uint brickList[]; };
layout(std430, binding = 1) readonly buffer BrickCount { uint listed; };
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
#endif
#if DIRECTIONS
layout(std430, binding = 4) readonly buffer DirectionalSums { VoxelDirections directions[]; };
#include "../face_sums.glsl"
const uint kFaces = 6u;
uint fragmentsAt(uint place) { return directions[place].fragments; }
vec3 meanAt(uint place, uint face) { return radianceOfFace(place, int(face), 1.0, 1.0); }
#else
layout(std430, binding = 4) readonly buffer Sums { VoxelSums sums[]; };
const uint kFaces = 1u;
uint fragmentsAt(uint place) { return sums[place].fragments; }
vec3 meanAt(uint place, uint face) {
  vec3 light = vec3(sums[place].red, sums[place].green, sums[place].blue);
  return sums[place].coverage == 0u ? vec3(0.0) : light / float(sums[place].coverage) * uintBitsToFloat(sums[place].brightest);
}
#endif
layout(std430, binding = 6) writeonly buffer ReflectedNow { float reflectedNow[]; };  // as ReflectedBefore

// The voxel of this invocation, and the place of its sums; false: there is none.
bool voxelOfItem(out ivec3 voxel, out uint place) {
#if TREE
  uint brick, lane;
  if (!itemOf(octreeDepth, kBrickVoxels, brick, lane)) return false;
  voxel = 2 * unpackVoxel(octreeBricks[brick]) + voxelOfLane(lane);
  place = placeIn(brick, octreeLevels[octreeDepth].firstBrick, voxel);
  return true;
#else
  uint item = listIndex();
  if (item / 64u >= listed) return false;
  voxel = voxelOf(unpackVoxel(brickList[item / 64u]), item % 64u);
  Brick brick = bricks[brickOf(voxel, turnBricks)];
  place = sumsOf(brick, item % 64u);
  return isOccupied(brick, item % 64u);
#endif
}

void main() {
  ivec3 voxel;
  uint place, before;
  if (!voxelOfItem(voxel, place)) return;
  bool anew = fragmentsAt(place) > 0u, known = isKnown(voxel, before);
  for (uint face = 0u; face < kFaces; ++face) {
    vec3 value = vec3(kNothing);
    if (anew)
      value = meanAt(place, face);
    else if (known)
      value = vec3(reflectedBefore[before + 3u * face], reflectedBefore[before + 3u * face + 1u], reflectedBefore[before + 3u * face + 2u]);
    for (uint channel = 0u; channel < 3u; ++channel) reflectedNow[3u * (kFaces * place + face) + channel] = value[channel];
  }
}
