#version 450
// Lists the occupied bricks, and allocates the sums of their occupied voxels. The order depends on the threads; no result depends on it.
//
// CHANGED: only bricks in changed cells get sums, which begin at 0. These bricks are listed also if they were occupied only before
// (changed_bricks.comp).
#pragma lumivox axis CHANGED 0 1
#pragma lumivox axis DIRECTIONS 0 1
#pragma lumivox require CHANGED || !DIRECTIONS
#include "common/voxel.glsl"
#include "bricks.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
#if CHANGED
#include "toolkit/changed_cells.glsl"
#endif

layout(std140, binding = 0) uniform Size { ivec3 brickCount; };
layout(std430, binding = 3) buffer Bricks { Brick bricks[]; };
layout(std430, binding = 5) writeonly buffer BrickList { uint brickList[]; };
layout(std430, binding = 6) buffer BrickTotals {
  uint listed;  // bricks
  uint claimed; // voxels
};
#if CHANGED
layout(std430, binding = 8) writeonly buffer ChangedBrickList { uint changedBrickList[]; };
layout(std430, binding = 9) buffer ChangedTotals { uint changedListed; };
#if DIRECTIONS
layout(std430, binding = 4) writeonly buffer DirectionalSums { VoxelDirections directions[]; };
void empty(uint place) {
  directions[place].fragments = 0u;
  directions[place].brightest = 0u;
  for (int axis = 0; axis < 3; ++axis) directions[place].opacity[axis] = 0u;
  for (int face = 0; face < 24; ++face) directions[place].faces[face] = 0u;
}
#else
layout(std430, binding = 4) writeonly buffer Sums { VoxelSums sums[]; };
void empty(uint place) { sums[place] = VoxelSums(0u, 0u, 0u, 0u, 0u, 0u); }
#endif
#endif

void main() {
  ivec3 place = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(place, brickCount))) return;
  uint index = brickOf(4 * place, brickCount);
  uint voxels = uint(bitCount(bricks[index].low) + bitCount(bricks[index].high));
#if CHANGED
  bool changed = isChanged(cellOf(4 * place), cellDepth);
  if (changed && (voxels > 0u || bricks[index].first > 0u)) changedBrickList[atomicAdd(changedListed, 1u)] = packVoxel(place);
#endif
  if (voxels == 0u) return;
  brickList[atomicAdd(listed, 1u)] = packVoxel(place);
#if CHANGED
  if (!changed) return;
#endif
  uint first = atomicAdd(claimed, voxels);
  bricks[index].first = first;
#if CHANGED
  for (uint i = 0u; i < voxels; ++i) empty(first + i);
#endif
}
