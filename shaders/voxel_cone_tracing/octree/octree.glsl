// A sparse voxel octree: Crassin et al. 2011, Sec. 4; thesis 004, Sec. 3.1.1. Depth 0 is the root, `octreeDepth` the depth of the leaves.
// One bit per possible node tells whether the node exists (octree_tags.glsl); the node's brick is the number of nodes before it
// (octree_ranks.glsl). The brick of node n of a depth has the voxels 2n and 2n + 1 of that depth along
// each axis, so that each voxel is stored once.
// C++ side: VoxelOctree in techniques/voxel_cone_tracing/octree/radiance_octree.h.
#ifndef LUMIVOX_OCTREE
#define LUMIVOX_OCTREE
#include "toolkit/bit_tree.glsl"

layout(std140, binding = 3) uniform Octree {
  int octreeDepth;      // of the leaves
  int octreePoolShift;  // the pool has 2^octreePoolShift bricks along x and along y
};
#ifdef OCTREE_BUILD
#define OCTREE_ACCESS
#else
#define OCTREE_ACCESS readonly
#endif

const uint kBrickVoxels = 8u;

// The first texel of a brick in a pool with 2^shift bricks along x and along y.
ivec3 texelIn(int shift, uint brick) {
  uint row = (1u << shift) - 1u;
  return 2 * ivec3(brick & row, brick >> shift & row, brick >> 2 * shift);
}
ivec3 texelOf(uint brick) { return texelIn(octreePoolShift, brick); }

// If voxels have six faces, the pool has six consecutive bricks per brick, for the outward normals +x, -x, +y, -y, +z and -z.
const uint kBrickFaces = 6u;
uint brickOfFace(uint brick, uint face) { return kBrickFaces * brick + face; }

#endif
