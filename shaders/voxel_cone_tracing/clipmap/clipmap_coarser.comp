#version 450
// Lists the cells of a level of a clipmap whose read values may differ from the last frame, if no level has moved: their voxelization
// differs, or the read values of the finer level differ.
layout(local_size_x = 64) in;
#include "clipmap.glsl"
#include "clipmap_cells.glsl"
#include "clipmap_cell_voxels.glsl"
#define ITEMS_BUILD
#include "clipmap_items.glsl"

layout(std140, binding = 0) uniform Level { int level; };
layout(std430, binding = 9) buffer ReadCells { uint readCells[]; };  // indexed like clipmapCells; level 0 is unused

bool differs(int of, ivec3 cell) {
  uint index = cellIndex(of, 4 * cell, ownFirst[0].w);
  return (of == 0 ? clipmapCells[index] : readCells[index]) != 0u;
}
bool differsFiner(int finer, ivec3 first, ivec3 end) {
  first = max(2 * first - ownFirst[finer].xyz, ivec3(0)) >> 2;
  end = min(2 * end, ownEnd[finer].xyz) - ownFirst[finer].xyz;
  for (int z = first.z; 4 * z < end.z; ++z)
    for (int y = first.y; 4 * y < end.y; ++y)
      for (int x = first.x; 4 * x < end.x; ++x)
        if (differs(finer, ivec3(x, y, z))) return true;
  return false;
}

void main() {
  int along = cellsAlong(ownFirst[0].w), cells = along * along * along, cell = int(listIndex());
  if (cell >= cells) return;
  ivec3 first, end;
  voxelsOfCell(level, cell, first, end);
  bool isAbove = level >= clipmapLevels, isThere = all(lessThan(first, end));
  bool read = isThere && ((!isAbove && clipmapCells[level * cells + cell] != 0u) || differsFiner(level - 1, first, end));
  readCells[level * cells + cell] = uint(read);
  bool isMade = isAbove || (all(lessThan(first, innerEnd[level].xyz)) && all(greaterThan(end, innerFirst[level].xyz)));
  if (read && isMade) putItem(level, uint(cell), 64u);
}
