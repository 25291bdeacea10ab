#version 450
// Pre-filters one level of an octree from the next finer level by the rule of filter.comp: the eight children of a coarse voxel are the
// voxels of one child's brick.
//
// Deviates from Crassin et al. 2011, Sec. 5, where coarse voxels lie at the corners of nodes: there a wall one voxel thick between two
// coarse voxels makes both opaque, and trilinear reads widen it to three coarse voxels.
//
// LIT: only the bricks that photons have changed (octree_lit.comp); the others are complete.
// CHANGED: bricks that have not changed since static geometry was lit are copied from the static octree.
// DIRECTIONS: voxels with six faces, by the rule of filter_directional.comp.
#pragma lumivox axis LIT 0 1
#pragma lumivox axis CHANGED 0 1
#pragma lumivox axis DIRECTIONS 0 1
#pragma lumivox require !LIT || (!CHANGED && !DIRECTIONS)
layout(local_size_x = 64) in;
#include "common/coarser_voxel.glsl"
#include "octree_levels.glsl"
#include "octree_ranks.glsl"
#if CHANGED
#include "toolkit/changed_cells.glsl"
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

#if DIRECTIONS
uint finerBrick;
vec4 higherFace(int axis, ivec3 child) { return texelFetch(pool, texelOf(brickOfFace(finerBrick, 2u * uint(axis))) + child, 0); }
vec4 lowerFace(int axis, ivec3 child) { return texelFetch(pool, texelOf(brickOfFace(finerBrick, 2u * uint(axis) + 1u)) + child, 0); }
#include "../columns.glsl"
const uint kFaces = kBrickFaces;

// The faces of the coarse voxel whose children are the voxels of brick `finer`; kNone: an empty voxel.
void filtered(uint finer, out vec4 faces[kFaces]) {
  for (uint face = 0u; face < kFaces; ++face) faces[face] = vec4(0.0);
  if (finer == kNone) return;
  finerBrick = finer;
  for (int axis = 0; axis < 3; ++axis) lookThrough(ivec3(0), axis, ivec3(0), ivec3(1), vec3(2.0), faces[2 * axis], faces[2 * axis + 1]);
}
#else
const uint kFaces = 1u;

void filtered(uint finer, out vec4 faces[kFaces]) {
  faces[0] = vec4(0.0);
  if (finer == kNone) return;
  vec4 child[8];
  for (int i = 0; i < 8; ++i) child[i] = texelFetch(pool, texelOf(finer) + ivec3(i & 1, i >> 1 & 1, i >> 2), 0);
  if (rule == kFacing) faces[0] = seenThrough(child);
  for (int i = 0; i < 8 && rule == kAverage; ++i) faces[0] += child[i] / 8.0;
}
#endif

void main() {
  uint brick, lane;
  if (!itemOf(depth, kBrickVoxels, brick, lane)) return;
#if LIT
  if (lit[brick] == 0u) return;
#endif
  ivec3 voxel = voxelOfLane(lane);
  uint morton = mortonOf(unpackVoxel(octreeBricks[brick]));
#if CHANGED
  if (!isChanged(morton, depth)) {
    for (uint face = 0u; face < kFaces; ++face)
      imageStore(poolImage, texelOf(kFaces * brick + face) + voxel, stillVoxel(morton, depth, voxel, face));
    return;
  }
#endif
  vec4 faces[kFaces];
  filtered(rankedBrick(morton << 3 | lane, depth + 1), faces);
  for (uint face = 0u; face < kFaces; ++face) imageStore(poolImage, texelOf(kFaces * brick + face) + voxel, faces[face]);
}
