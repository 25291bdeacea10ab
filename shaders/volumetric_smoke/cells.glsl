// Integrals of densities from a point outwards, exact near the point, so that smoke that is opaque within a voxel shades like a surface.
#ifndef LUMIVOX_SMOKE_CELLS
#define LUMIVOX_SMOKE_CELLS
#include "common/media.glsl"

const float kOpaque = 100.0;  // optical depth behind which nothing is visible
const float kLeastTransmittance = 1e-37;  // near the smallest normal float, so that its logarithm is finite

const int kAllCells = 1 << 20;  // more cells than any range has

#if MEDIUM == MEDIUM_VARYING
// Integral of a heterogeneous medium's density along a ray, m, from range.x to `reached`: to range.y, or through `mostCells` of the cubes
// between the centres of voxels. Within a cube a trilinear density is a cubic polynomial of the distance, which two-point Gauss-Legendre
// quadrature integrates exactly. Traversal by Amanatides & Woo 1987, "A fast voxel traversal algorithm for ray tracing".
float integralOverCells(int i, vec3 origin, vec3 direction, vec2 range, int mostCells, out float reached) {
  const float kGauss = 0.57735027;  // 1 / sqrt(3)
  reached = range.x;
  vec3 rate = direction / media[i].gridLowVoxel.w;
  rate = mix(rate, vec3(1e-30), equal(rate, vec3(0.0)));
  vec3 place = (origin + direction * range.x - media[i].gridLowVoxel.xyz) / media[i].gridLowVoxel.w - 0.5;
  vec3 next = range.x + (floor(place) + vec3(greaterThan(rate, vec3(0.0))) - place) / rate;  // exit from the cube along each axis
  float sum = 0.0;
  for (int cell = 0; cell < mostCells && reached < range.y; ++cell) {
    float end = clamp(min(min(next.x, next.y), next.z), reached, range.y);
    float middle = 0.5 * (reached + end), side = 0.5 * (end - reached);
    if (side > 0.0)
      sum += side * (densityAt(i, origin + direction * (middle - kGauss * side)) +
                     densityAt(i, origin + direction * (middle + kGauss * side)));
    next += mix(vec3(0.0), abs(1.0 / rate), lessThanEqual(next, vec3(end)));
    reached = end;
  }
  return sum;
}

// Optical depth of all media from a point to the end of a ray: exact over the first cells, then by the midpoint rule with one step per
// voxel but at most `mostSteps`.
vec3 depthFrom(vec3 origin, vec3 direction, float reach, int mostCells, int mostSteps) {
  vec3 depth = evenDepth(origin, direction, reach);
  for (int i = 0; i < mediumCount; ++i) {
    if (isEven(i)) continue;
    vec2 inside = insideMedium(i, origin, direction, reach);
    if (inside.x >= inside.y) continue;
    float begin, sum = integralOverCells(i, origin, direction, inside, mostCells, begin);
    float extent = inside.y - begin;
    int steps = int(clamp(ceil(extent / media[i].gridLowVoxel.w), 1.0, float(mostSteps)));
    float stride = extent / float(steps);
    for (int s = 0; s < steps && extent > 0.0; ++s) sum += stride * densityAt(i, origin + direction * (begin + (float(s) + 0.5) * stride));
    depth += media[i].extinction.rgb * sum;
  }
  return depth;
}
#endif

#endif
