#version 450
// Finds the cells of a clipmap's levels whose voxels may differ from the last frame: a moving object has left or entered the cell, or the
// light of the cell changes. A cell found needlessly only costs being filled again, so the test is
// conservative. Lists the occupied changed cells.
#pragma lumivox axis LIGHTS 0 1
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "clipmap.glsl"
#define CELLS_BUILD
#include "clipmap_cells.glsl"
#include "clipmap_cell_voxels.glsl"
#define ITEMS_BUILD
#include "clipmap_items.glsl"

#if LIGHTS
#include "toolkit/shadowed_anew.glsl"
#endif

layout(std140, binding = 0) uniform Moved {
  int boxCount;
  int lightCount;
  float texel;  // of the shadow views, in clip space
};
struct Box {
  vec4 low, high;  // m
};
layout(std430, binding = 0) readonly buffer Moving { Box moving[]; };
#include "clipmap_occupied.glsl"

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

// Whether any of `count` voxels in a row is occupied; at most 32, with consecutive addresses.
bool isAnyOccupied(ClipmapPlace place, int count) {
  uint shift = uint(findLSB(place.bit)), bits = clipmapOccupied[place.word] >> shift;
  if (shift + uint(count) > 32u) bits |= clipmapOccupied[place.word + 1u] << (32u - shift);
  return bitfieldExtract(bits, 0, count) != 0u;
}
bool holdsAnything(int level, ivec3 first, ivec3 end) {
  int count = end.x - first.x;
  for (int z = first.z; z < end.z; ++z)
    for (int y = first.y; y < end.y; ++y) {
      ClipmapPlace place = ownPlace(level, ivec3(first.x, y, z));
      int before = min(count, place.period - place.address.x);  // addresses wrap around
      if (isAnyOccupied(place, before)) return true;
      if (before < count && isAnyOccupied(ownPlace(level, ivec3(first.x + before, y, z)), count - before)) return true;
    }
  return false;
}

void main() {
  int along = cellsAlong(ownFirst[0].w), cells = along * along * along, item = int(listIndex()), level = item / cells;
  if (level >= clipmapLevels) return;
  ivec3 first, end;
  voxelsOfCell(level, item % cells, first, end);
  float size = clipmapVoxel * exp2(float(level));
  vec3 low = clipmapOrigin + size * vec3(first), high = clipmapOrigin + size * vec3(end);
  // One voxel more on each side, for rounding.
  bool holds = holdsAnything(level, first, end), changed = isTouched(low - size, high + size) || (holds && isLitAnew(low, high));
  clipmapCells[item] = uint(changed);
  if (holds && changed) putItem(0, uint(item), 64u);
}
