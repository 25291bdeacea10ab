#version 450
// Pre-filtering of one level of an octree from the next finer one as filter.comp does it: the eight children of a coarse voxel are the voxels
// that one child's brick owns. Each brick gets the eight voxels that are its own; the others are copied (octree_transfer.comp).
//
// Deviates from Crassin et al. 2011, Sec. 5 (octree_filter_part.comp): a wall one voxel thick that lies between two coarse voxels makes both
// opaque there, and grows to three of them in trilinear reading.
//
// LIT: only the bricks that photons have changed (octree_lit.comp); the others are there already.
// CHANGED: what has not changed since static geometry was lit is copied from there.
#pragma lumivox axis LIT 0 1
#pragma lumivox axis CHANGED 0 1
#pragma lumivox require !LIT || !CHANGED
layout(local_size_x = 64) in;
#include "children.glsl"
#include "octree_levels.glsl"
#include "octree_ranks.glsl"
#if CHANGED
#include "changed_cells.glsl"
#include "octree_still.glsl"
#endif

const int kFacing = 0, kAverage = 1;
layout(constant_id = 0) const int rule = kFacing;

layout(std140, binding = 0) uniform Coarse { int depth; };
#if LIT
layout(std430, binding = 4) readonly buffer Lit { uint lit[]; };  // by brick
#endif
layout(binding = 0) uniform sampler3D pool;
layout(binding = 0) uniform writeonly image3D poolImage;  // the same

// The brick of a child of a brick's node.
uint childBrick(OctreeBrick brick, uint child) {
  if (octreeRanked != 0) return rankedBrick(mortonOf(unpackVoxel(brick.place)) << 3 | child, depth + 1);
  uint tile = octreeNodes[brick.node].children;
  return tile == kNone ? kNone : octreeNodes[tile + child].brick;
}

void main() {
  uint brick, lane;
  if (!itemOf(depth, voxelsOfBrick(), brick, lane)) return;
#if LIT
  if (lit[brick] == 0u) return;
#endif
  ivec3 voxel = voxelOfLane(lane);
#if CHANGED
  uint morton = mortonOf(unpackVoxel(octreeBricks[brick].place));
  if (!isChanged(morton, depth)) {
    imageStore(poolImage, texelOf(brick) + voxel, stillVoxel(morton, depth, voxel));
    return;
  }
#endif
  vec4 value = vec4(0.0);  // of those that are copied, unless there is nothing to copy
  if (all(lessThan(voxel, ivec3(2)))) {
    uint finer = childBrick(octreeBricks[brick], uint(voxel.x | voxel.y << 1 | voxel.z << 2));
    if (finer != kNone) {
      vec4 child[8];
      for (int i = 0; i < 8; ++i) child[i] = texelFetch(pool, texelOf(finer) + ivec3(i & 1, i >> 1 & 1, i >> 2), 0);
      if (rule == kFacing) value = seenThrough(child);
      for (int i = 0; i < 8 && rule == kAverage; ++i) value += child[i] / 8.0;
    }
  }
  imageStore(poolImage, texelOf(brick) + voxel, value);
}
