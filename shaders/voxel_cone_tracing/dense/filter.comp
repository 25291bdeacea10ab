#version 450
// Pre-filters one level from the next finer level (Crassin et al. 2011, Sec. 5; thesis 004 Sec. 4.2.1 Mipmapping).
//
// The rule is that of common/coarser_level.glsl: `facing`, or the published mean of the eight children, `average`.
//
// OCCUPIED: filters only the coarse voxels in occupied bricks of 4 x 4 x 4 finest voxels; the others are 0 already. A brick has 2 x 2 x 2
// voxels of level 1 and one voxel of level 2.
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

layout(constant_id = 0) const int rule = 0;  // in the order of Opacity in levels.h

layout(std140, binding = 0) uniform Parameters {
  ivec3 coarse;   // voxels of the level that is written
  int fineLevel;
  ivec3 fine;     // voxels of the level that is read
};
layout(binding = 0) uniform sampler3D radianceGrid;
layout(binding = 0) uniform writeonly image3D radianceImage;  // of any float format

vec4 finerVoxel(ivec3 at) { return texelFetch(radianceGrid, at, fineLevel); }
#include "common/coarser_level.glsl"

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
  imageStore(radianceImage, cell, coarserVoxel(cell, coarse, fine, rule));
}
