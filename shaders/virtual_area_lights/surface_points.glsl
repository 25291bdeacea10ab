// Points distributed over the surfaces, and the look-up grid that finds the nearest points. C++ side:
// port SurfacePoints; SurfacePointsBinding in framework/include/lumivox/toolkit/bindings.h.
#ifndef LUMIVOX_SURFACE_POINTS
#define LUMIVOX_SURFACE_POINTS

#include "point_texel.glsl"

layout(std140, binding = 7) uniform PointGrid {
  vec3 pointGridLow;      // m
  float pointCellsPerMetre;
  ivec3 pointCells;       // along each axis
  int pointCount;
  float pointSpacing;     // m: mean side of the square that a point represents
  float pointFarthest;    // m: search radius of neighbours; the nearest neighbour may be farther
};
layout(binding = 8) uniform sampler2D pointPosition;  // xyz posWorld; w area, m^2
layout(binding = 9) uniform sampler2D pointNormal;    // xyz unit, 0 for a degenerate triangle; w model
layout(binding = 10) uniform sampler2D pointRadius;   // x radius, m; y Phong exponent; z 1: glossy; w 1: front, 0: back of a point

// A smaller cosine between normals means the other side of the surface; C++ side: techniques/virtual_area_lights/points/surface_points.h.
const float kOtherSideCosine = -0.5;
// From this cosine on normals count as similar; a smaller cosine means across an edge. C++ side:
// techniques/virtual_area_lights/points/surface_points.cpp.
const float kAlikeCosine = 0.05;

#ifdef POINT_CANDIDATES
layout(std430, binding = 6) readonly buffer PointCells { uint pointCellFirst[]; };  // first candidate of each cell, then the total
layout(std430, binding = 7) readonly buffer PointCandidates { uint pointCandidates[]; };

// Range of pointCandidates that may be among the nearest points of a position on the surface: from x on and before y. They include points
// of all models and both sides. There are fewer than SurfacePoints::neighbours only if no more points lie within pointFarthest.
uvec2 candidatesAt(vec3 posWorld) {
  ivec3 cell = clamp(ivec3(floor((posWorld - pointGridLow) * pointCellsPerMetre)), ivec3(0), pointCells - 1);
  int index = cell.x + pointCells.x * (cell.y + pointCells.y * cell.z);
  return uvec2(pointCellFirst[index], pointCellFirst[index + 1]);
}
#endif

#endif
