// The bricks around a node in which trilinear reading from its voxels finds something. A node may be shown that has no
// brick, since only its neighbours have.
#ifndef LUMIVOX_OCTREE_CORNERS
#define LUMIVOX_OCTREE_CORNERS
#include "octree.glsl"
#include "toolkit/bit_tree.glsl"

#ifdef OCTREE_BUILD
#define OCTREE_CORNERS_ACCESS writeonly
#else
#define OCTREE_CORNERS_ACCESS readonly
#endif
layout(std430, binding = 13) readonly buffer OctreeShown { RankedTags octreeShown[]; };
// Of each shown node its own brick and those at higher x, y, z, x first; kNone: there is none.
layout(std430, binding = 14) OCTREE_CORNERS_ACCESS buffer OctreeCorners { uint octreeCorners[]; };

// The first of the eight bricks around a node by its place along the curve of its depth; kNone: nothing is shown.
uint cornersOf(uint morton, int depth) {
  uint shown = rankIn(octreeShown[firstWord(depth) + (morton >> 5)], morton);
  return shown == kNone ? kNone : 8u * shown;
}

#endif
