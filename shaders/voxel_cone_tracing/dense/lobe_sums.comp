#version 450
// Sums of the normals of the lit sides of a voxel's fragments, weighted by the light that they reflect, for lobes of normals (thesis 004,
// Sec. 3.1.2). Integers, in units of the brightest fragment of the voxel (common/integer_mean.glsl).
#pragma lumivox require PLACES == grid && !CHANGED
#include "../bricks.glsl"
#include "common/integer_mean.glsl"

layout(local_size_x = 64) in;
#include "common/fragments.glsl"
#include "lobes.glsl"

layout(std140, binding = 0) uniform Size { ivec3 brickCount; };
layout(std430, binding = 2) readonly buffer Radiances { float radiances[]; };  // r, g, b per side of a fragment, W/(sr m^2)
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
layout(std430, binding = 4) readonly buffer DirectionalSums { VoxelDirections directions[]; };
layout(std430, binding = 5) buffer LobeSums { Lobe lobes[]; };
#include "../sums.glsl"

float lightOf(uint first) { return (radiances[first] + radiances[first + 1] + radiances[first + 2]) / 3.0; }

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  uint place = sumsAt(unpackVoxel(fragment.voxel));
  float brightest = uintBitsToFloat(directions[place].brightest);
  if (!(brightest > 0.0)) return;
  float coverage = clamp(unpackHalf2x16(fragment.albedoBCoverage).y, 0.0, 1.0);
  float front = lightOf(6 * index) / brightest, back = lightOf(6 * index + 3) / brightest;
  float weight = kLobeShare * coverage / float(max(directions[place].fragments, 1u));
  vec4 lobe = weight * vec4(unpackNormal(fragment.normal) * (front - back), front + back);
  for (int i = 0; i < 4; ++i) atomicAdd(lobes[place].sums[i], signedShareOf(lobe[i]));
}
