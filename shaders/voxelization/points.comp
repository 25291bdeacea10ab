#version 450
// Mavridis & Papaioannou 2011, Sec. 3.1: N random points on each triangle, uniform over its area, mark the voxels that they fall into.
// Deviates: one thread a triangle in a compute shader in place of a geometry shader that emits points. A triangle of many points is put
// aside and shared out over many threads (MANY 1), so that none waits for a single thread.
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
  float pointsPerVoxel;  // above 0: as many points as the triangle has squared voxel sizes of area, times this
  uvec2 seed;
  int mostPoints;  // of one triangle
};
// 1: points in the middles of equal parts of the triangle; 0: random. A constant, so that no thread has the code of both.
layout(constant_id = 0) const int regular = 0;
#include "aside.glsl"

const int kPointsPerThread = 64;

// Sec. 3.1 speaks of a regular tessellation too: each edge in k parts makes k^2 triangles, of which the middles are the points.
int edgeParts(int points) {
  int k = int(ceil(sqrt(float(points))));
  // The root of a square may be rounded up.
  return (k - 1) * (k - 1) >= points ? k - 1 : k;
}

int randomPointsOf(vec3 corners[3]) {
  if (pointsPerVoxel <= 0.0) return pointsPerTriangle;
  // Sec. 3.1 speaks of adapting N to the size of the triangle: N = ceil(density * area / voxel size^2).
  float area = 0.5 * length(cross(corners[1] - corners[0], corners[2] - corners[0]));
  return int(clamp(ceil(pointsPerVoxel * area), 1.0, float(mostPoints)));
}

int pointsOf(vec3 corners[3]) {
  int count = randomPointsOf(corners), k = edgeParts(count);
  return regular != 0 ? k * k : count;
}

// The middle of part `n` of k^2, counted in rows from the first corner on: row r, from r to r + 1 edge parts away from that corner, has
// r + 1 triangles that point to it and r that point away, in turns.
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
