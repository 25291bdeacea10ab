// Exact traversal of the voxels along a ray (Amanatides & Woo 1987, "A fast voxel traversal algorithm for ray tracing"), and the shading of
// the sides of voxels.
#ifndef LUMIVOX_VOXEL_WALK
#define LUMIVOX_VOXEL_WALK
#include "toolkit/voxel_field.glsl"

const int kWithin = 3;  // instead of a side's axis: the ray begins inside the voxel

struct VoxelWalk {
  bool inside;          // false: the ray has left the grid, or misses it
  ivec3 voxel;
  int side;             // axis of the side through which the ray enters the voxel
  float from, to;       // m along the ray, within the voxel
  float end;            // where the ray leaves the grid, m
  ivec3 turn;
  vec3 next, perVoxel;  // m to the next planes, and from plane to plane
};

int axisOfLeast(vec3 v) { return v.x <= v.y && v.x <= v.z ? 0 : v.y <= v.z ? 1 : 2; }

// Begins `from` metres along the ray, or where the ray meets the grid.
VoxelWalk startWalk(vec3 origin, vec3 direction, float from) {
  const vec3 kLevel = vec3(1e-12);  // avoids division by 0; the motion along the axis stays negligible
  vec3 slope = mix(direction, kLevel, lessThan(abs(direction), kLevel));
  vec3 toLow = (gridLow - origin) / slope, toHigh = (gridLow + voxelSides * vec3(gridResolution) - origin) / slope;
  vec3 near = min(toLow, toHigh), far = max(toLow, toHigh);
  VoxelWalk walk;
  walk.side = axisOfLeast(-near);
  walk.from = near[walk.side];
  if (from >= walk.from) {
    walk.side = kWithin;
    walk.from = from;
  }
  walk.end = min(far.x, min(far.y, far.z));
  walk.inside = walk.from < walk.end;
  vec3 at = (origin + direction * walk.from - gridLow) / voxelSides;
  walk.voxel = clamp(ivec3(floor(at)), ivec3(0), gridResolution - 1);
  walk.turn = ivec3(sign(slope));
  walk.perVoxel = abs(voxelSides / slope);
  walk.next = walk.from + mix(vec3(walk.voxel) - at, vec3(walk.voxel) + 1.0 - at, greaterThan(slope, vec3(0.0))) * voxelSides / slope;
  walk.to = max(min(walk.next[axisOfLeast(walk.next)], walk.end), walk.from);
  return walk;
}

void nextVoxel(inout VoxelWalk walk) {
  walk.side = axisOfLeast(walk.next);
  walk.from = walk.to;
  bvec3 crossed = equal(ivec3(0, 1, 2), ivec3(walk.side));
  walk.voxel += mix(ivec3(0), walk.turn, crossed);
  walk.next += mix(vec3(0.0), walk.perVoxel, crossed);
  walk.inside = walk.from < walk.end && all(greaterThanEqual(walk.voxel, ivec3(0))) && all(lessThan(walk.voxel, gridResolution));
  walk.to = max(min(walk.next[axisOfLeast(walk.next)], walk.end), walk.from);
}

// Brightness of the side through which a ray enters a voxel at a point, so that voxels stand out from each other. Edges are darker where
// they are wide enough for the pixels; `pixelWidth`: width of a pixel at the point, m.
float sideBrightness(int side, vec3 point, float pixelWidth, bool edges) {
  const float kSides[4] = float[4](0.8, 1.0, 0.65, 0.5);  // across x, y and z, and within
  if (!edges) return kSides[side];
  float shortest = shortestSide(), pixel = pixelWidth / shortest;
  vec3 place = fract((point - gridLow) / voxelSides), toEdge = min(place, 1.0 - place) * voxelSides / shortest;
  if (side != kWithin) toEdge[side] = 1.0;
  float line = min(toEdge.x, min(toEdge.y, toEdge.z)) < max(0.03, 0.6 * pixel) ? clamp(1.0 - 4.0 * pixel, 0.0, 1.0) : 0.0;
  return kSides[side] * (1.0 - 0.65 * line);
}

#endif
