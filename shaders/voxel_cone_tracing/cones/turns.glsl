// Voxels reflect the light of the frame before in turns: each once in as many frames.
// TREE: the voxels of an octree's leaves, with the bindings of octree_levels.glsl; otherwise those of a grid. Included after the local size,
// which is along x only.
// C++ side: Bounces in techniques/voxel_cone_tracing/cones/bounces.h.
#ifndef LUMIVOX_TURNS
#define LUMIVOX_TURNS
#pragma lumivox axis TREE 0 1
#include "../bricks.glsl"
#include "toolkit/bit_tree.glsl"

layout(std140, binding = 4) uniform Turns {
  ivec3 turnBricks;     // bricks of a grid along each axis
  int turns;            // frames in which each voxel has one turn: 1, 2, 4 or 8
  int turn;             // of this frame
  int followsFrame;     // 1: the buffers ...Before hold the frame before
  int facesOfVoxel;     // 1 or 6
};
// What voxels reflected in the frame before: r, g, b of each face, W/(sr m^2); kNothing where they held no fragments.
layout(std430, binding = 5) readonly buffer ReflectedBefore { float reflectedBefore[]; };
const float kNothing = -1.0;

// One of eight turns. Voxels beside each other differ, and a wall across any axis has as many voxels of each turn, so that frames cost the
// same and a mean over few voxels changes little from frame to frame.
int turnOf(ivec3 voxel) {
  ivec3 low = voxel & 1, next = voxel >> 1 & 1;
  return (low.x ^ 2 * low.y ^ 3 * low.z) | (next.x ^ next.y ^ next.z) << 2;
}
bool hasTurn(ivec3 voxel) { return (turnOf(voxel) & (turns - 1)) == turn; }

#if TREE
#include "../octree/octree_levels.glsl"
layout(std430, binding = 13) readonly buffer RanksBefore { RankedTags ranksBefore[]; };
layout(std430, binding = 14) readonly buffer LevelsBefore {
  uint totalsBefore[3];
  OctreeLevel levelsBefore[];
};

uint placeIn(uint leaf, uint firstLeaf, ivec3 voxel) {
  ivec3 own = voxel & 1;
  return 8u * (leaf - firstLeaf) + uint(own.x | own.y << 1 | own.z << 2);
}
// The place of a voxel in the frame before; kNone: it had none.
uint placeBefore(ivec3 voxel) {
  uint morton = mortonOf(voxel >> 1), leaf = rankIn(ranksBefore[firstWord(octreeDepth) + (morton >> 5)], morton);
  return leaf == kNone ? kNone : placeIn(leaf, levelsBefore[octreeDepth].firstBrick, voxel);
}
#else
layout(std430, binding = 9) readonly buffer BricksBefore { Brick bricksBefore[]; };

uint placeBefore(ivec3 voxel) {
  Brick brick = bricksBefore[brickOf(voxel, turnBricks)];
  return isOccupied(brick, bitOf(voxel)) ? sumsOf(brick, bitOf(voxel)) : kNone;
}
#endif

// The first value of what a voxel reflected in the frame before; false: that is not known.
bool isKnown(ivec3 voxel, out uint first) {
  uint place = followsFrame != 0 ? placeBefore(voxel) : kNone;
  first = 3u * uint(facesOfVoxel) * place;
  return place != kNone && reflectedBefore[first] != kNothing;
}

#endif
