#version 450
// Pre-filtering of one level from the next finer one (Crassin et al. 2011, Sec. 5; thesis 004 Sec. 4.2.1 Mipmapping).
//
// Along each of the three axes the children are composited front to back in each column, both ways, and the columns are averaged: what
// looking through the coarse voxel along that axis would see. Its opacity is the largest of the three, that of the axis which a surface
// faces. So
// - a uniform medium of opacity a per voxel gets 1 - (1-a)^2: its transmittance does not depend on the level that a cone reads;
// - a sheet one voxel thick of opacity a keeps a at every level, while the plain mean of the thesis halves it at every level and lets
//   light escape. So does, more slowly, any mean over the axes: along the sheet only half of the columns meet it.
// Radiance over opacity is a mean of what is blended, over the axes weighted by the square of their opacities. `average` is the
// published mean of the eight children, over all that a coarse voxel shares in; `trilinear` is that as printed, one read between eight
// children by the filter of the texture, which at odd sizes misses the others.
//
// OCCUPIED: only the coarse voxels in occupied bricks of 4 x 4 x 4 finest voxels are made; the others are 0 already. A brick has 2 x 2 x 2
// voxels of level 1 and one of level 2.
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

#include "filter_cell.glsl"

void main() {
#if OCCUPIED
  uint item = listIndex();
  uint perBrick = fineLevel == 0 ? 8u : 1u;
  if (item / perBrick >= listed) return;
  ivec3 brick = unpackVoxel(brickList[item / perBrick]);
  ivec3 cell = fineLevel == 0 ? 2 * brick + ivec3(item & 1u, item >> 1 & 1u, item >> 2 & 1u) : brick;
#else
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, coarse))) return;
#endif
  filterCell(cell);
}
