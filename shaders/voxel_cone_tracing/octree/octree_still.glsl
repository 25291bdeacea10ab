// Reads the voxels of the octree of static geometry, which exists beside that of all geometry. Including files have the axis DIRECTIONS.
#include "octree_ranks.glsl"

layout(std430, binding = 13) readonly buffer StillRanks { RankedTags stillRanks[]; };
layout(binding = 1) uniform sampler3D stillPool;
layout(std140, binding = 6) uniform StillBricks { int stillShift; };  // the static pool has 2^stillShift bricks along x and along y

// A voxel of a node, given by the node's place along the curve of its depth; 0 if the node does not exist.
vec4 stillVoxel(uint morton, int depth, ivec3 own, uint face) {
  uint brick = rankIn(stillRanks[firstWord(depth) + (morton >> 5)], morton);
#if DIRECTIONS
  if (brick != kNone) brick = brickOfFace(brick, face);
#endif
  return brick == kNone ? vec4(0.0) : texelFetch(stillPool, texelIn(stillShift, brick) + own, 0);
}
