// Both sides of the surface in a voxel, by its two bands and the mean of its normals.
#ifndef LUMIVOX_SURFACE_SIDES
#define LUMIVOX_SURFACE_SIDES
#include "common/spherical_harmonics.glsl"

// Normals that disagree more than this leave no side: two sheets back to back, whose mean is 0.
const float kLeastNormal = 1.0 / 64.0;

vec3 firstBand(vec4 coefficients) { return coefficients.wyz; }

// The direction of unit length in which a voxel's surface looks: the mean of its normals, or, where they cancel out, that in which the light
// of `coefficients` differs most; 0 where both sides are the same.
vec3 surfaceNormal(vec3 meanNormal, vec4 red, vec4 green, vec4 blue) {
  if (dot(meanNormal, meanNormal) > kLeastNormal * kLeastNormal) return normalize(meanNormal);
  vec3 along = firstBand(red + green + blue);
  float largest = max(max(abs(along.x), abs(along.y)), abs(along.z));
  return largest > 0.0 ? normalize(along / largest) : vec3(0.0);
}

// What the side of the normal sends, from the coefficients of two sides that each shine alike over their half space, of L+ and L-:
// (L+ + L-) 2 pi Y0 and (L+ - L-) pi Y1 n.
vec3 sideOf(vec4 red, vec4 green, vec4 blue, vec3 normal) {
  vec3 both = vec3(red.x, green.x, blue.x) / (2.0 * kPi * kY0);
  vec3 difference = vec3(dot(firstBand(red), normal), dot(firstBand(green), normal), dot(firstBand(blue), normal)) / (kPi * kY1);
  return max(0.5 * (both + difference), 0.0);
}

#endif
