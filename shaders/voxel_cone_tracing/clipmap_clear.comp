#version 450
// Empties the voxels of a box of one level of a clipmap.
//
// CHANGED: those in changed cells alone.
#pragma lumivox axis CHANGED 0 1
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#include "clipmap_write.glsl"
#if CHANGED
#include "clipmap_cells.glsl"
#endif

layout(std140, binding = 0) uniform Box {
  ivec3 first;
  int level;
  ivec3 end;
};

void main() {
  ivec3 voxel = first + ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, end))) return;
#if CHANGED
  if (clipmapCells[cellIndex(level, voxel - ownFirst[level].xyz, ownFirst[level].w)] == 0u) return;
#endif
  ClipmapPlace place = ownPlace(level, voxel);
  if (!isOccupied(place)) return;
  vec4 faces[6] = vec4[6](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  writeVoxel(place, faces, false);
}
