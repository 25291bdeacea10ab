// The bricks that trilinear reads from the voxels of a node need. A node is `shown` if one of these bricks exists, even if the node itself
// has no brick.
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
// For each shown node its own brick and the seven bricks at higher x, y and z, with x fastest; kNone: no brick.
layout(std430, binding = 14) OCTREE_CORNERS_ACCESS buffer OctreeCorners { uint octreeCorners[]; };

// Index of the first of the eight bricks around a node, given by its place along the curve of its depth; kNone: the node is not shown.
uint cornersOf(uint morton, int depth) {
  uint shown = rankIn(octreeShown[firstWord(depth) + (morton >> 5)], morton);
  return shown == kNone ? kNone : 8u * shown;
}

#endif
