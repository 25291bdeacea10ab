#version 450
// Parity fill: each triangle of a closed surface flips every voxel of a column behind it, so that the voxels inside are flipped an odd
// number of times. This pass flips only the first of these voxels; solid_fill.comp carries the parity to the end of the column.
// Deviates from rasterising the triangles: a column's centre line meets a triangle if a ray in the projection crosses an odd number of its
// edges. An edge gives the same answer for both of its triangles, whatever the rounding, so every line meets a closed surface an even
// number of times and no column leaks. The coverage rules of rasterisation guarantee this only without clipping. A triangle over many
// columns is put aside and spread over many threads (MANY 1).
#pragma lumivox axis MANY 0 1
#define SCENE_GEOMETRY
#include "common/scene.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 1) uniform Surface {
  int firstTriangle;  // in the list
  int triangleCount;
};
#include "../list_grid.glsl"
#include "../grid_corner.glsl"
layout(std430, binding = 7) readonly buffer Triangles { uint triangles[]; };  // of closed surfaces
#include "../aside.glsl"
layout(binding = 0, r32ui) uniform uimage3D parity;

const int kColumnsPerThread = 64;

struct Projected {
  vec3 corners[3];
  ivec2 low, size;  // columns whose centre lines may meet the triangle
};

Projected project(int triangle) {
  Projected p;
  for (int k = 0; k < 3; ++k) p.corners[k] = cornerInGrid(triangle, k);
  vec2 low = min(p.corners[0].xy, min(p.corners[1].xy, p.corners[2].xy));
  vec2 high = max(p.corners[0].xy, max(p.corners[1].xy, p.corners[2].xy));
  // Clamped as floats: coordinates far outside the grid overflow an integer.
  p.low = ivec2(clamp(floor(low), vec2(0.0), vec2(resolution.xy)));
  p.size = max(ivec2(clamp(ceil(high), vec2(0.0), vec2(resolution.xy))) - p.low, 0);
  return p;
}

// Whether the ray from `point` along +x crosses the edge. The ends are sorted first, so that both triangles of the edge agree.
bool crosses(vec2 a, vec2 b, vec2 point) {
  if ((a.y <= point.y) == (b.y <= point.y)) return false;
  if (b.y < a.y) {
    vec2 swap = a;
    a = b;
    b = swap;
  }
  return point.x < a.x + (b.x - a.x) * ((point.y - a.y) / (b.y - a.y));
}

void flip(Projected p, ivec2 column) {
  vec2 centre = vec2(column) + 0.5;
  vec3 a = p.corners[0], b = p.corners[1], c = p.corners[2];
  bool met = crosses(a.xy, b.xy, centre);
  if (crosses(b.xy, c.xy, centre)) met = !met;
  if (crosses(c.xy, a.xy, centre)) met = !met;
  if (!met) return;
  vec3 normal = cross(b - a, c - a);
  float low = min(a.z, min(b.z, c.z)), high = max(a.z, max(b.z, c.z));
  float depth = normal.z != 0.0 ? a.z - dot(normal.xy, centre - a.xy) / normal.z : 0.5 * (low + high);
  depth = clamp(depth, low, high);
  // The first voxel whose centre lies behind the triangle: 0 for a triangle before the grid; none for a triangle behind the grid.
  int first = int(clamp(floor(depth + 0.5), 0.0, float(resolution.z)));
  if (first < resolution.z) imageAtomicXor(parity, ivec3(column, first >> 5), 1u << (first & 31));
}

void main() {
#if MANY
  int lane = int(gl_WorkGroupID.y * gl_WorkGroupSize.x + gl_LocalInvocationID.x);
  int lanes = int(gl_NumWorkGroups.y * gl_WorkGroupSize.x);
  for (uint i = gl_WorkGroupID.x; i < asideCount; i += gl_NumWorkGroups.x) {
    Projected p = project(int(aside[i]));
    for (int n = lane; n < p.size.x * p.size.y; n += lanes) flip(p, p.low + ivec2(n % p.size.x, n / p.size.x));
  }
#else
  int item = int(listIndex());
  if (item >= triangleCount) return;
  int triangle = int(triangles[firstTriangle + item]);
  Projected p = project(triangle);
  int columns = p.size.x * p.size.y;
  if (columns > kColumnsPerThread) {
    putAside(triangle);
    return;
  }
  for (int n = 0; n < columns; ++n) flip(p, p.low + ivec2(n % p.size.x, n / p.size.x));
#endif
}
