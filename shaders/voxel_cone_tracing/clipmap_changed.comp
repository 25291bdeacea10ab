#version 450
// Finds the cells of a clipmap's levels in which the voxels may differ from those of the frame before: what moves has left or come to them, or
// light arrives there otherwise. A cell that is found is filled anew and nothing else, so that it does no harm to find too many.
#pragma lumivox axis LIGHTS 0 1
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

#if LIGHTS
#include "shadowed_anew.glsl"
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

bool holdsAnything(int level, ivec3 first, ivec3 end) {
  for (int z = first.z; z < end.z; ++z)
    for (int y = first.y; y < end.y; ++y)
      for (int x = first.x; x < end.x; ++x)
        if (isOccupied(ownPlace(level, ivec3(x, y, z)))) return true;
  return false;
}

void main() {
  int along = cellsAlong(ownFirst[0].w), cells = along * along * along, item = int(listIndex()), level = item / cells;
  if (level >= clipmapLevels) return;
  ivec3 first, end;
  voxelsOf(level, item % cells, first, end);
  float size = clipmapVoxel * exp2(float(level));
  vec3 low = clipmapOrigin + size * vec3(first), high = clipmapOrigin + size * vec3(end);
  // A voxel more to each side for rounding.
  bool changed = isTouched(low - size, high + size) || (holdsAnything(level, first, end) && isLitAnew(low, high));
  clipmapCells[item] = uint(changed);
}
