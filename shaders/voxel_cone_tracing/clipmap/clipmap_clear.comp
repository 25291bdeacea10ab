#version 450
// Clears the voxels in a box of one level of a clipmap.
//
// CHANGED: clears the voxels of the cells that clipmap_changed.comp has listed, in all levels.
#pragma lumivox axis CHANGED 0 1
#if CHANGED
layout(local_size_x = 64) in;
#else
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#endif
#include "clipmap_write.glsl"

void empty(int level, ivec3 voxel) {
  ClipmapPlace place = ownPlace(level, voxel);
  if (!isOccupied(place)) return;
  vec4 faces[6] = vec4[6](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  writeVoxel(place, faces, false);
}

#if CHANGED
#include "clipmap_cells.glsl"
#include "clipmap_cell_voxels.glsl"
#include "clipmap_items.glsl"

void main() {
  int along = cellsAlong(ownFirst[0].w), cells = along * along * along, lane = int(gl_LocalInvocationID.x);
  uint count = heads[0].count;
  for (uint i = gl_WorkGroupID.x; i < count; i += gl_NumWorkGroups.x) {
    int level = int(items[i]) / cells;
    ivec3 first, end;
    voxelsOfCell(level, int(items[i]) % cells, first, end);
    ivec3 voxel = first + ivec3(lane & 3, lane >> 2 & 3, lane >> 4);
    if (all(lessThan(voxel, end))) empty(level, voxel);
  }
}
#else
layout(std140, binding = 0) uniform Box {
  ivec3 first;
  int level;
  ivec3 end;
};

void main() {
  ivec3 voxel = first + ivec3(gl_GlobalInvocationID);
  if (all(lessThan(voxel, end))) empty(level, voxel);
}
#endif
