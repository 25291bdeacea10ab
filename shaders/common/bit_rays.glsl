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

// No voxel that a plane touches reaches further from it, in voxels, than the sum of the sides of its normal; the sixteenth keeps a plane that
// lies in the faces of voxels off the next ones.
float reachOfPlane(vec3 normal) {
  vec3 sides = abs(normal);
  return sides.x + sides.y + sides.z + 1.0 / 16.0;
}

// Point `number` of the R2 sequence (Roberts 2018) in the unit square, turned: multiples of the powers of 1 / 1.32472 in parts of 2^32, so
// that no point is too many.
uvec2 wordsOfR2(uint number, uvec2 turn) { return number * uvec2(3242174889u, 2447445413u) + 0x80000000u + turn; }

// A direction about a normal, distributed as the cosine; `spread` is the largest sine of its angle, squared (thesis Gomes 2015, Listing 4.45).
vec3 cosineDirection(vec2 point, float spread, vec3 tangent, vec3 bitangent, vec3 normal) {
  float radius = sqrt(point.x * spread), angle = 2.0 * kPi * point.y;
  float x = radius * cos(angle), y = radius * sin(angle);
  return normalize(x * tangent + y * bitangent + sqrt(max(1.0 - x * x - y * y, 0.0)) * normal);
}
#endif
