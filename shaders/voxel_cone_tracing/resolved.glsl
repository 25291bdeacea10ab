// Voxels of a store from the integer sums over their fragments (add.comp), for passes that write the finest level.
// REFLECTED: with what voxels reflect of light that cones gather (cones/reflected.comp).
#ifndef LUMIVOX_RESOLVED
#define LUMIVOX_RESOLVED
#pragma lumivox axis REFLECTED 0 1
#include "bricks.glsl"
#include "common/integer_mean.glsl"

// One value for all sides: radiance in units of `unit`, pre-multiplied by opacity, and opacity: the mean coverage; `addsUp`: the sum, at
// most 1.
vec4 surfacesOf(VoxelSums sum, bool addsUp, float unit) {
  vec4 value = meanOf(uvec4(sum.red, sum.green, sum.blue, sum.coverage));
  if (addsUp) {
    // The sums hold means over the fragments; radiance over opacity does not change.
    float opacity = min(value.a * float(sum.fragments), 1.0);
    value = vec4(value.a > 0.0 ? value.rgb * (opacity / value.a) : vec3(0.0), opacity);
  }
  return vec4(value.rgb * (uintBitsToFloat(sum.brightest) / unit), min(value.a, 1.0));
}

#if REFLECTED
// r, g, b of each face of each voxel, by the place of its sums, W/(sr m^2).
layout(std430, binding = 9) readonly buffer Reflected { float reflected[]; };

// Adds to the direct light of a voxel, or of a face, what its share `value.a` reflects beside it.
vec4 withReflected(vec4 value, uint number, float unit) {
  return vec4(value.rgb + vec3(reflected[3u * number], reflected[3u * number + 1u], reflected[3u * number + 2u]) * (value.a / unit), value.a);
}
#else
vec4 withReflected(vec4 value, uint number, float unit) { return value; }
#endif

#endif
