#version 450
// Pre-filtering of one level of an octree from the next finer one as filter.comp does it: the eight children of a coarse voxel are the voxels
// that one child's brick owns. Each brick gets the eight voxels that are its own; the others are copied (octree_transfer.comp).
//
// Deviates from Crassin et al. 2011, Sec. 5 (octree_filter_part.comp): a wall one voxel thick that lies between two coarse voxels makes both
// opaque there, and grows to three of them in trilinear reading.
layout(local_size_x = 64) in;
#include "children.glsl"
#include "octree_levels.glsl"

const int kFacing = 0, kAverage = 1;
layout(constant_id = 0) const int rule = kFacing;

layout(std140, binding = 0) uniform Coarse { int depth; };
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // the same

void main() {
  uint brick, lane;
  if (!itemOf(depth, 8u, brick, lane)) return;
  uint tile = octreeNodes[octreeBricks[brick].node].children, finer = tile == kNone ? kNone : octreeNodes[tile + lane].brick;
  vec4 value = vec4(0.0);
  if (finer != kNone) {
    vec4 child[8];
    for (int i = 0; i < 8; ++i) child[i] = texelFetch(pool, texelOf(finer) + ivec3(i & 1, i >> 1 & 1, i >> 2), 0);
    if (rule == kFacing) value = seenThrough(child);
    for (int i = 0; i < 8 && rule == kAverage; ++i) value += child[i] / 8.0;
  }
  imageStore(poolImage, texelOf(brick) + ivec3(lane & 1u, lane >> 1 & 1u, lane >> 2), value);
}
