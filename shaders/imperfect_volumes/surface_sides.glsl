// Both sides of the surface in a voxel, from the voxel's two bands and its mean normal.
#ifndef LUMIVOX_SURFACE_SIDES
#define LUMIVOX_SURFACE_SIDES
#include "common/spherical_harmonics.glsl"

// A mean normal shorter than this has no direction: for two sheets back to back, the mean is 0.
const float kLeastNormal = 1.0 / 64.0;

vec3 firstBand(vec4 coefficients) { return coefficients.wyz; }

// The unit normal of a voxel's surface: the mean normal, or, if the normals cancel out, the direction in which the light differs most
// between the sides; 0 if both sides are the same.
vec3 surfaceNormal(vec3 meanNormal, vec4 red, vec4 green, vec4 blue) {
  if (dot(meanNormal, meanNormal) > kLeastNormal * kLeastNormal) return normalize(meanNormal);
  vec3 along = firstBand(red + green + blue);
  float largest = max(max(abs(along.x), abs(along.y)), abs(along.z));
  return largest > 0.0 ? normalize(along / largest) : vec3(0.0);
}

// Radiance of the side of the normal, from the coefficients of two sides that each have a uniform radiance over their half space, L+ and
// L-: (L+ + L-) 2 pi Y0 and (L+ - L-) pi Y1 n.
vec3 sideOf(vec4 red, vec4 green, vec4 blue, vec3 normal) {
  vec3 both = vec3(red.x, green.x, blue.x) / (2.0 * kPi * kY0);
  vec3 difference = vec3(dot(firstBand(red), normal), dot(firstBand(green), normal), dot(firstBand(blue), normal)) / (kPi * kY1);
  return max(0.5 * (both + difference), 0.0);
}

#endif
