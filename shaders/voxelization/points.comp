#version 450
// Mavridis & Papaioannou 2011, Sec. 3.1: N random points on each triangle, uniform over its area, mark the voxels that they fall into.
// Deviates: a compute shader with one thread per triangle instead of a geometry shader that emits points. A triangle with many points is
// put aside and spread over many threads (MANY 1), so that it does not occupy a single thread.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#pragma lumivox axis MANY 0 1
#include "surface_point.glsl"
#include "common/random.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 2) uniform Points {
  int firstTriangle;  // of this draw
  int triangleCount;
  int pointsPerTriangle;
  float pointsPerVoxel;  // above 0: points per area of one squared voxel size; otherwise pointsPerTriangle counts
  uvec2 seed;
  int mostPoints;  // limit of the points of one triangle
};
// 1: points at the centroids of equal parts of the triangle; 0: random. A specialization constant, so that only one of them is compiled.
layout(constant_id = 0) const int regular = 0;
#include "aside.glsl"

const int kPointsPerThread = 64;

// Sec. 3.1 also mentions a regular tessellation: k parts per edge give k^2 triangles, whose centroids are the points.
int edgeParts(int points) {
  int k = int(ceil(sqrt(float(points))));
  // The computed root of a square number may be rounded up.
  return (k - 1) * (k - 1) >= points ? k - 1 : k;
}

int randomPointsOf(vec3 corners[3]) {
  if (pointsPerVoxel <= 0.0) return pointsPerTriangle;
  // Sec. 3.1 mentions adapting N to the size of the triangle: N = ceil(density * area / voxel size^2).
  float area = 0.5 * length(cross(corners[1] - corners[0], corners[2] - corners[0]));
  return int(clamp(ceil(pointsPerVoxel * area), 1.0, float(mostPoints)));
}

int pointsOf(vec3 corners[3]) {
  int count = randomPointsOf(corners), k = edgeParts(count);
  return regular != 0 ? k * k : count;
}

// Barycentric coordinates of the centroid of part `n` of k^2. Parts are counted in rows from the first corner: row r, between r and r + 1
// edge parts away from this corner, alternates between r + 1 triangles that point to the corner and r that point away.
vec3 middleOf(int n, int k) {
  int r = int(sqrt(float(n)));
  r = r * r > n ? r - 1 : (r + 1) * (r + 1) <= n ? r + 1 : r;
  int i = n - r * r;
  bool towards = (i & 1) == 0;
  float away = float(r) + (towards ? 2.0 : 1.0) / 3.0, along = float(i / 2) + (towards ? 1.0 : 2.0) / 3.0;
  return vec3(float(k) - away, away - along, along) / float(k);
}

// Point number `n` of a triangle, uniform over its area: (1 - sqrt r1) a + (1 - r2) sqrt r1 b + r2 sqrt r1 c (Turk 1990).
void place(int triangle, vec3 corners[3], int n, int count) {
  if (regular != 0) {
    appendPoint(triangle, corners, middleOf(n, edgeParts(count)));
    return;
  }
  vec2 random = unitInterval(hash4(uvec4(uint(triangle), uint(n), seed)).xy);
  float root = sqrt(random.x);
  appendPoint(triangle, corners, vec3(1.0 - root, (1.0 - random.y) * root, random.y * root));
}

void main() {
#if MANY
  int lane = int(gl_WorkGroupID.y * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  int lanes = int(gl_NumWorkGroups.y * gl_WorkGroupSize.x);
  for (uint i = gl_WorkGroupID.x; i < asideCount; i += gl_NumWorkGroups.x) {
    int triangle = int(aside[i]);
    vec3 corners[3] = vec3[3](cornerInGrid(triangle, 0), cornerInGrid(triangle, 1), cornerInGrid(triangle, 2));
    int count = pointsOf(corners);
    for (int n = lane; n < count; n += lanes) place(triangle, corners, n, count);
  }
#else
  int item = int(listIndex());
  if (item >= triangleCount) return;
  int triangle = firstTriangle + item;
  vec3 corners[3] = vec3[3](cornerInGrid(triangle, 0), cornerInGrid(triangle, 1), cornerInGrid(triangle, 2));
  int count = pointsOf(corners);
  if (count > kPointsPerThread) {
    putAside(triangle);
    return;
  }
  for (int n = 0; n < count; ++n) place(triangle, corners, n, count);
#endif
}
