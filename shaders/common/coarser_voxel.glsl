// A coarse voxel from its children (Crassin et al. 2011, Sec. 5). Radiance is pre-multiplied by opacity.
#ifndef LUMIVOX_COARSER_VOXEL
#define LUMIVOX_COARSER_VOXEL
#include "common/cones.glsl"

// Fraction of child `child` that lies in coarse voxel `cell` along one axis. With an even number of children it is 1 for two of them. With
// an odd number a coarse voxel is a little wider than two children and shares some with its neighbours.
float share(int cell, int child, float childrenPerCell) {
  float low = float(cell) * childrenPerCell, high = low + childrenPerCell;
  return clamp(min(high, float(child + 1)) - max(low, float(child)), 0.0, 1.0);
}

// A child seen through `length` of its own width.
vec4 slab(vec4 value, float length) {
  if (length >= 1.0 || value.a <= 0.0) return length >= 1.0 ? value : vec4(0.0);
  float opacity = 1.0 - pow(max(1.0 - value.a, 0.0), length);
  return vec4(value.rgb * (opacity / value.a), opacity);
}

// The usual case, two whole children along each axis, without loops. The sum of the views of one column from both of its ends.
vec4 pair(vec4 a, vec4 b) { return over(a, b) + over(b, a); }

// Combines the values of the three axes: the largest opacity; radiance over opacity weighted by the squares of the opacities.
vec4 facing(vec4 x, vec4 y, vec4 z) {
  float largest = max(x.a, max(y.a, z.a));
  if (largest <= 0.0) return vec4(0.0);
  vec3 weight = vec3(x.a, y.a, z.a) / largest;
  weight *= weight;
  vec4 sum = weight.x * x + weight.y * y + weight.z * z;
  return vec4(sum.rgb * (largest / sum.a), largest);
}

// The coarse voxel of eight whole children, in the order x, y, z with x fastest. Its opacity is that of the most opaque axis.
vec4 seenThrough(vec4 child[8]) {
  float most = 0.0;
  for (int i = 0; i < 8; ++i) most = max(most, child[i].a);
  if (most == 0.0) return vec4(0.0);
  vec4 x = pair(child[0], child[1]) + pair(child[2], child[3]) + pair(child[4], child[5]) + pair(child[6], child[7]);
  vec4 y = pair(child[0], child[2]) + pair(child[1], child[3]) + pair(child[4], child[6]) + pair(child[5], child[7]);
  vec4 z = pair(child[0], child[4]) + pair(child[1], child[5]) + pair(child[2], child[6]) + pair(child[3], child[7]);
  return facing(x, y, z) / 8.0;
}

#endif
