// Rays from surfaces through the bits of a grid. C++ side: framework/include/lumivox/toolkit/voxel_rays.h.
#ifndef LUMIVOX_BIT_RAYS
#define LUMIVOX_BIT_RAYS
#include "common/bit_grid.glsl"
#include "common/constants.glsl"

layout(std140, binding = 0) uniform Grid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 resolution;
};

// The largest distance, in voxels, from a plane to any point of a voxel that the plane touches: the sum of the absolute components of its
// normal. The sixteenth of a voxel keeps a ray from a plane that lies exactly in voxel faces out of the voxels beside it.
float reachOfPlane(vec3 normal) {
  vec3 sides = abs(normal);
  return sides.x + sides.y + sides.z + 1.0 / 16.0;
}

// Point `number` of the R2 sequence (Roberts 2018) in the unit square, shifted by `turn`, in units of 2^-32: multiples of the powers of
// 1 / 1.32472. The integers wrap around, so that the sequence keeps its precision at any number.
uvec2 wordsOfR2(uint number, uvec2 turn) { return number * uvec2(3242174889u, 2447445413u) + 0x80000000u + turn; }

// A cosine-distributed direction about a normal; `spread` is the squared sine of the largest angle (thesis Gomes 2015, Listing 4.45).
vec3 cosineDirection(vec2 point, float spread, vec3 tangent, vec3 bitangent, vec3 normal) {
  float radius = sqrt(point.x * spread), angle = 2.0 * kPi * point.y;
  float x = radius * cos(angle), y = radius * sin(angle);
  return normalize(x * tangent + y * bitangent + sqrt(max(1.0 - x * x - y * y, 0.0)) * normal);
}
#endif
