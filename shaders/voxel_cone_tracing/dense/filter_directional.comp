#version 450
// One level of the six directional grids from the next finer one (Crassin et al. 2011, Sec. 8.1; thesis 004, Sec. 3.1.3 and 4.2.1,
// Fig. 64): the children of a column are composited front to back as seen from that side, and the columns are averaged.
//
// Along an axis a uniform medium of opacity a per voxel gets 1 - (1-a)^2, and a sheet across it keeps its opacity at every level. Both
// sides of an axis have the same opacity, and radiance of their own.
//
// OCCUPIED: only the coarse voxels in occupied bricks of 4 x 4 x 4 finest voxels, as in filter.comp.
#pragma lumivox axis OCCUPIED 0 1

#if OCCUPIED
#include "common/voxel.glsl"
layout(local_size_x = 64) in;
#include "common/list.glsl"
layout(std430, binding = 0) readonly buffer BrickList { uint brickList[]; };
layout(std430, binding = 1) readonly buffer BrickCount { uint listed; };
#else
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#endif

#include "filter_directional_cell.glsl"

void main() {
#if OCCUPIED
  uint item = listIndex();
  if (item / uint(perBrick) >= listed) return;
  ivec3 brick = unpackVoxel(brickList[item / uint(perBrick)]);
  ivec3 cell = perBrick == 8 ? 2 * brick + ivec3(item & 1u, item >> 1 & 1u, item >> 2 & 1u) : brick;
#else
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, coarse))) return;
#endif
  filterCell(cell);
}
