#version 450
// Finds the cells of a clipmap's levels in which the voxels may differ from those of the frame before: what moves has left or come to them, or
// light arrives there otherwise. A cell that is found is filled anew and nothing else, so that it does no harm to find too many.
//
// FINER: what is read of a cell differs as well where it does in the finer level; of one level.
#pragma lumivox axis FINER 0 1
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox require !FINER || !LIGHTS
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "clipmap.glsl"
#define CELLS_BUILD
#include "clipmap_cells.glsl"

// Of item `cell` of a level the voxels.
void voxelsOf(int level, int cell, out ivec3 first, out ivec3 end) {
  int along = cellsAlong(ownFirst[level].w);
  first = ownFirst[level].xyz + 4 * ivec3(cell % along, cell / along % along, cell / (along * along));
  end = min(first + 4, ownEnd[level].xyz);
}

#if FINER
layout(std140, binding = 0) uniform Level { int level; };

void main() {
  int along = cellsAlong(ownFirst[level].w), cells = along * along * along, cell = int(listIndex());
  if (cell >= cells || (clipmapCells[level * cells + cell] & kRead) != 0u) return;
  ivec3 first, end;
  voxelsOf(level, cell, first, end);
  int finer = level - 1;
  first = max(2 * first - ownFirst[finer].xyz, ivec3(0)) >> 2;
  end = min(2 * end, ownEnd[finer].xyz) - ownFirst[finer].xyz;
  for (int z = first.z; 4 * z < end.z; ++z)
    for (int y = first.y; 4 * y < end.y; ++y)
      for (int x = first.x; 4 * x < end.x; ++x)
        if ((clipmapCells[cellIndex(finer, 4 * ivec3(x, y, z), ownFirst[finer].w)] & kRead) != 0u) {
          clipmapCells[level * cells + cell] |= kRead;
          return;
        }
}
#else
#if LIGHTS
#include "shadowed_anew.glsl"
#endif

const int kMostStacked = 12;
layout(std140, binding = 0) uniform Moved {
  ivec4 stayFirst[kMostStacked];  // of each level the voxels that it had in the frame before
  ivec4 stayEnd[kMostStacked];
  int boxCount;
  int lightCount;
  float texel;  // of the shadow views, in clip space
};
struct Box {
  vec4 low, high;  // m
};
layout(std430, binding = 0) readonly buffer Moving { Box moving[]; };
layout(std430, binding = 13) readonly buffer ClipmapOccupied { uint clipmapOccupied[]; };

#if LIGHTS
bool isLitAnew(vec3 low, vec3 high) { return isShadowedAnew(low, high, lightCount, boxCount, texel); }
#else
bool isLitAnew(vec3 low, vec3 high) { return false; }
#endif

bool isTouched(vec3 low, vec3 high) {
  for (int i = 0; i < boxCount; ++i)
    if (all(lessThanEqual(low, moving[i].high.xyz)) && all(lessThanEqual(moving[i].low.xyz, high))) return true;
  return false;
}

bool holdsAnything(int level, ivec3 first, ivec3 end) {
  for (int z = first.z; z < end.z; ++z)
    for (int y = first.y; y < end.y; ++y)
      for (int x = first.x; x < end.x; ++x) {
        ClipmapPlace place = ownPlace(level, ivec3(x, y, z));
        if ((clipmapOccupied[place.word] & place.bit) != 0u) return true;
      }
  return false;
}

void main() {
  int along = cellsAlong(ownFirst[0].w), cells = along * along * along, item = int(listIndex()), level = item / cells;
  if (level >= clipmapLevels) return;
  ivec3 first, end;
  voxelsOf(level, item % cells, first, end);
  float size = clipmapVoxel * exp2(float(level));
  vec3 low = clipmapOrigin + size * vec3(first), high = clipmapOrigin + size * vec3(end);
  uint flags = 0u;
  // A voxel more to each side for rounding.
  if (isTouched(low - size, high + size) || (holdsAnything(level, first, end) && isLitAnew(low, high)))
    flags = kVoxelized | kRead;
  if (any(lessThan(first, stayFirst[level].xyz)) || any(greaterThan(end, stayEnd[level].xyz))) flags |= kRead;
  clipmapCells[item] = flags;
}
#endif
