// Points spread over the surfaces, and the look-up grid that finds the nearest ones. C++ side: port SurfacePoints; SurfacePointsBinding in
// framework/include/lumivox/toolkit/bindings.h.
#ifndef LUMIVOX_SURFACE_POINTS
#define LUMIVOX_SURFACE_POINTS

const uint kPointsInRow = 1024u;  // SurfacePoints::kWidth

layout(std140, binding = 7) uniform PointGrid {
  vec3 pointGridLow;      // m
  float pointCellsPerMetre;
  ivec3 pointCells;       // along each axis
  int pointCount;
  float pointSpacing;     // m: side of the square that a point stands for, in the mean
  float pointFarthest;    // m: how far away neighbours are sought; the nearest one may be farther
};
layout(binding = 8) uniform sampler2D pointPosition;  // xyz posWorld; w area, m^2
layout(binding = 9) uniform sampler2D pointNormal;    // xyz unit, 0 where nothing is left of the triangle; w model
layout(binding = 10) uniform sampler2D pointRadius;   // x radius, m; y Phong exponent; z 1: glossy; w 1: front, 0: back of another point

ivec2 pointTexel(uint point) { return ivec2(point % kPointsInRow, point / kPointsInRow); }

// Normals at a larger angle are of another side of the surface; C++ side: techniques/virtual_area_lights/points/surface_points.h.
const float kOtherSideCosine = -0.5;
// From this cosine on normals face alike; less is across an edge. C++ side: techniques/virtual_area_lights/points/surface_points.cpp.
const float kAlikeCosine = 0.05;

#ifdef POINT_CANDIDATES
layout(std430, binding = 6) readonly buffer PointCells { uint pointCellFirst[]; };  // of each cell, and one more
layout(std430, binding = 7) readonly buffer PointCandidates { uint pointCandidates[]; };

// Which of pointCandidates may be among the nearest points of a place of the surface: from x on, up to y, which is none of them. They
// are of all models and of both sides. Fewer than SurfacePoints::neighbours
// where no more are within pointFarthest.
uvec2 candidatesAt(vec3 posWorld) {
  ivec3 cell = clamp(ivec3(floor((posWorld - pointGridLow) * pointCellsPerMetre)), ivec3(0), pointCells - 1);
  int index = cell.x + pointCells.x * (cell.y + pointCells.y * cell.z);
  return uvec2(pointCellFirst[index], pointCellFirst[index + 1]);
}
#endif

#endif
