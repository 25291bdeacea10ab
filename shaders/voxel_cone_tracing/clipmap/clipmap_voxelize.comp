#version 450
// Voxelizes triangles into all levels of a clipmap at once, draw by draw (thesis 004 Sec. 3.5.2, where a geometry shader makes an instance
// of each triangle for each level). One invocation tests each pair of a triangle and a box of voxels to be filled, in any level. A level
// that only moved has boxes for the newly reached voxels.
//
// SAMPLED 0: one fragment per voxel that a triangle touches.
// SAMPLED 1: eight samples in each column along the dominant axis, as in Sec. 3.5.2, which uses multisampled rasterisation. The covered
// samples of a voxel give its opacity along each axis (covered_samples.glsl). Emittance uses the covered share of the voxel's side, with
// more samples for small triangles, so that the light of a moving object does not jump (Fig. 56).
// CHANGED: in some boxes, only the voxels in changed cells are filled.
// STAGE find lists the triangles that touch a box, usually few. As in voxelization, a triangle with many voxels is put aside as rows of
// tiles of 8 x 8 columns; STAGE large processes one row per work group. STAGE small processes one of the other triangles per invocation.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#pragma lumivox axis STAGE find small large
#pragma lumivox axis SAMPLED 0 1
#pragma lumivox axis CHANGED 0 1
#define SCENE_GEOMETRY
#define SCENE_MATERIALS
#include "common/scene.glsl"
#include "common/voxel.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "clipmap_stack.glsl"

const int kMostBoxes = 64;
layout(std140, binding = 1) uniform Part {
  int firstIndex;      // of the draw
  int triangleCount;
  int capacity;        // fragments
  int rowCapacity;
  int mostScale;       // SAMPLED: largest number of pixels along a voxel
  float thickness;     // SAMPLED: thickness of a surface seen from the side, voxels
};
layout(std140, binding = 2) uniform Boxes {
  ivec4 boxFirst[kMostBoxes];  // voxels of a level; w: the level
  ivec4 boxEnd[kMostBoxes];    // w 1: only changed cells are filled
};
layout(std430, binding = 6) readonly buffer Indices { uint indices[]; };
layout(std430, binding = 7) buffer Count { uint fragmentCount; };
layout(std430, binding = 8) writeonly buffer Fragments { VoxelFragment fragments[]; };
struct TileRow {
  uint triangle, box;
  int y;
};
layout(std430, binding = 9) buffer Rows {
  uint rowCount;
  uint rowGroupsX, rowGroupsY, rowGroupsZ;  // of the dispatch over them
  TileRow rows[];
};
layout(std430, binding = 11) buffer Few {
  uint fewCount;
  uint fewGroupsX, fewGroupsY, fewGroupsZ;
  TileRow few[];  // triangles with few voxels; and the rest, from y on, of triangles for whose rows there was no room
};
#if SAMPLED
layout(std430, binding = 10) writeonly buffer SideMasks { uint sideMasksOf[]; };  // one word per fragment
#endif

// The level that is being voxelized.
vec3 gridLow;     // m
float voxelSize;  // m
int level;

#include "common/corners.glsl"
#include "common/column_sample.glsl"

#if CHANGED
#include "clipmap_cells.glsl"
bool onlyChanges;  // whether only changed cells of the box are filled

bool isTaken(ivec3 voxel, int axis) {
  return !onlyChanges || clipmapCells[cellIndex(level, unpermute(voxel, axis) - stackFirst[level].xyz, stackSide)] != 0u;
}
// Whether any voxel of a range may be filled; a range of many cells is not searched and gives true.
bool isAnyTaken(ivec3 low, ivec3 high, int axis) {
  const int kFewCells = 3;
  ivec3 first = unpermute(low, axis) - stackFirst[level].xyz, last = unpermute(high, axis) - stackFirst[level].xyz;
  if (!onlyChanges || any(greaterThanEqual((last >> 2) - (first >> 2), ivec3(kFewCells)))) return true;
  for (int z = first.z >> 2; z <= last.z >> 2; ++z)
    for (int y = first.y >> 2; y <= last.y >> 2; ++y)
      for (int x = first.x >> 2; x <= last.x >> 2; ++x)
        if (clipmapCells[cellIndex(level, 4 * ivec3(x, y, z), stackSide)] != 0u) return true;
  return false;
}
#else
bool isTaken(ivec3 voxel, int axis) { return true; }
bool isAnyTaken(ivec3 low, ivec3 high, int axis) { return true; }
#endif

const int kTile = 8;
const int kFewVoxels = 64;  // largest number of voxels of a triangle for one invocation

void put(ColumnSample s, ivec3 voxel, int axis, float share, uint masks) {
  uint index = atomicAdd(fragmentCount, 1u);
  if (index >= uint(capacity)) return;
  VoxelFragment fragment = fragmentAt(s, voxel, axis);
  fragment.voxel = packVoxel(unpermute(voxel, axis) - stackFirst[level].xyz + cornerInStack(level));
#if SAMPLED
  vec2 blueCoverage = unpackHalf2x16(fragment.albedoBCoverage);
  fragment.albedoBCoverage = packHalves(vec2(blueCoverage.x, blueCoverage.y * share));
  sideMasksOf[index] = masks;
#endif
  fragments[index] = fragment;
}

#if SAMPLED
// The standard pattern of eight samples, in sixteenths of a pixel from its corner.
const int kMostSamples = 8, sampleCount = 8;
const vec2 samples[kMostSamples] =
    vec2[8](vec2(9, 5) / 16.0, vec2(7, 11) / 16.0, vec2(13, 9) / 16.0, vec2(5, 3) / 16.0, vec2(3, 13) / 16.0, vec2(1, 7) / 16.0,
            vec2(11, 15) / 16.0, vec2(15, 1) / 16.0);
#include "common/covered_samples.glsl"

// Whether a point lies on the inner side of an edge. Both triangles of the edge compute the same number, so that a point belongs to exactly
// one of them.
bool inside(vec2 a, vec2 b, vec2 point, float orientation) {
  bool swaps = a.x > b.x || (a.x == b.x && a.y > b.y);
  vec2 low = swaps ? b : a, high = swaps ? a : b;
  float side = (high.x - low.x) * (point.y - low.y) - (high.y - low.y) * (point.x - low.x);
  float inwards = swaps == (orientation > 0.0) ? -side : side;
  return inwards > 0.0 || (inwards == 0.0 && swaps == (orientation > 0.0));
}
bool covers(mat3 corners, vec2 point, float orientation) {
  return inside(corners[0].xy, corners[1].xy, point, orientation) && inside(corners[1].xy, corners[2].xy, point, orientation) &&
         inside(corners[2].xy, corners[0].xy, point, orientation);
}

void appendSamples(TriangleCorners t, ColumnSample s, ivec2 column, ivec2 slices) {
  vec3 normal = cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]);
  if (normal.z == 0.0) return;
  vec2 slope = -normal.xy / normal.z;
  float depths[kMostSamples];
  uint covered = 0u;
  for (int i = 0; i < kMostSamples; ++i) {
    vec2 point = vec2(column) + samples[i];
    depths[i] = t.corners[0].z + dot(slope, point - t.corners[0].xy);
    if (covers(t.corners, point, normal.z)) covered |= 1u << i;
  }
  int scale = scaleOf(t.corners);
  if (covered == 0u && scale == 1) return;
  bool closes = unpackHalf2x16(s.fragment.albedoBCoverage).y >= kMaskThreshold;
  for (int slice = slices.x; slice <= slices.y; ++slice) {
    if (!isTaken(ivec3(column, slice), t.axis)) continue;
    uint there = 0u;
    for (int i = 0; i < kMostSamples; ++i)
      if (int(floor(depths[i])) == slice) there |= covered & 1u << i;
    int counted = bitCount(there);
    if (scale > 1) {
      counted = 0;
      for (int i = 0; i < scale * scale * kMostSamples; ++i) {
        int pixel = i / kMostSamples;
        vec2 point = vec2(column) + (vec2(pixel % scale, pixel / scale) + samples[i % kMostSamples]) / float(scale);
        float depth = t.corners[0].z + dot(slope, point - t.corners[0].xy);
        if (int(floor(depth)) == slice && covers(t.corners, point, normal.z)) ++counted;
      }
    }
    if (counted == 0 && there == 0u) continue;
    uint masks = closes && there != 0u ? sideMasks(there, depths, float(slice), t.axis) : 0u;
    put(s, ivec3(column, slice), t.axis, float(counted) / float(scale * scale * kMostSamples), masks);
  }
}
#endif

// Appends the fragments of all voxels of one column.
void appendColumn(TriangleCorners t, Overlap o, MaterialData material, VoxelFragment base, ivec2 column) {
  if (!touchesColumn(o, column)) return;
  ivec2 slices = depthsOfColumn(o, t.corners, column);
  if (slices.y >= slices.x && !isAnyTaken(ivec3(column, slices.x), ivec3(column, slices.y), t.axis)) return;
  ColumnSample s = sampleColumn(t.corners, t.normals, t.texcoords, material, base, column);
  if (isHole(s)) return;
#if SAMPLED
  appendSamples(t, s, column, slices);
#else
  for (int slice = slices.x; slice <= slices.y; ++slice)
    if (isTaken(ivec3(column, slice), t.axis) && touchesInColumn(o, ivec3(column, slice))) put(s, ivec3(column, slice), t.axis, 1.0, 0u);
#endif
}

TriangleCorners cornersIn(uint triangle, uint box, out Overlap o) {
  level = boxFirst[box].w;
#if CHANGED
  onlyChanges = boxEnd[box].w != 0;
#endif
  gridLow = stackOrigin;
  voxelSize = voxelSizeOf(level);
  TriangleCorners t = loadCorners(uint(firstIndex) + 3u * triangle, objectIndex);
  o = overlapIn(t.corners, permute(boxFirst[box].xyz, t.axis), permute(boxEnd[box].xyz, t.axis), stackLimits[level].y);
  return t;
}

#if STAGE == STAGE_FIND

void main() {
  uint triangle = gl_GlobalInvocationID.x, box = gl_WorkGroupID.y;
  if (triangle >= uint(triangleCount)) return;
  Overlap o;
  TriangleCorners t = cornersIn(triangle, box, o);
  ivec3 size = o.high - o.low + 1;
  if (any(lessThan(size, ivec3(1))) || !isAnyTaken(o.low, o.high, t.axis)) return;
  int first = o.low.y;
  if (size.x > kFewVoxels || size.y > kFewVoxels || size.x * size.y > kFewVoxels || size.x * size.y * size.z > kFewVoxels) {
    uint count = uint((size.y - 1) / kTile + 1), place = atomicAdd(rowCount, count), fits = min(count, uint(rowCapacity) - min(place, uint(rowCapacity)));
    if (fits > 0u) atomicMax(rowGroupsX, min(place + fits, kMostGroups));
    for (uint i = 0u; i < fits; ++i) rows[place + i] = TileRow(triangle, box, o.low.y + kTile * int(i));
    first += kTile * int(fits);  // rows without room go to the `few` list: slow but complete
    if (first > o.high.y) return;
  }
  uint place = atomicAdd(fewCount, 1u);
  few[place] = TileRow(triangle, box, first);
  atomicMax(fewGroupsX, min(place / gl_WorkGroupSize.x + 1u, kMostGroups));
}

#elif STAGE == STAGE_SMALL

void main() {
  MaterialData material = materials[materialIndex];
  VoxelFragment base = fragmentOf(material);
  uint count = fewCount;
  for (uint i = gl_WorkGroupID.x * gl_WorkGroupSize.x + gl_LocalInvocationID.x; i < count; i += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
    TileRow one = few[i];
    Overlap o;
    TriangleCorners t = cornersIn(one.triangle, one.box, o);
    for (int y = one.y; y <= o.high.y; ++y)
      for (int x = o.low.x; x <= o.high.x; ++x) appendColumn(t, o, material, base, ivec2(x, y));
  }
}

#else

void main() {
  ivec2 lane = ivec2(gl_LocalInvocationID.x % uint(kTile), gl_LocalInvocationID.x / uint(kTile));
  MaterialData material = materials[materialIndex];
  VoxelFragment base = fragmentOf(material);
  uint count = min(rowCount, uint(rowCapacity));
  for (uint r = gl_WorkGroupID.x; r < count; r += gl_NumWorkGroups.x) {
    TileRow row = rows[r];
    Overlap o;
    TriangleCorners t = cornersIn(row.triangle, row.box, o);
    int y = row.y + lane.y;
    if (y > o.high.y) continue;
    for (int x = o.low.x + lane.x; x <= o.high.x; x += kTile) appendColumn(t, o, material, base, ivec2(x, y));
  }
}

#endif
