// A sparse voxel octree: Crassin et al. 2011, Sec. 4; thesis 004, Sec. 3.1.1 and 4.2.2, Listing 4.16. Depth 0 is the root, `octreeDepth` that
// of the leaves. The eight children of a node are a tile of 2 x 2 x 2 nodes, one behind the other; the root has a tile to itself. Node n of a
// depth covers the voxels 2n to 2n + 2 of that depth along each axis: the 3 x 3 x 3 of its brick, which shares its sides with its
// neighbours', so that trilinear reading never leaves a brick. Or its brick has its own voxels 2n and 2n + 1 alone, so that each is held once:
// trees of such bricks have tags with ranks (octree_ranks.glsl) and no nodes.
// C++ side: VoxelOctree in techniques/voxel_cone_tracing/octree/radiance_octree.h.
#ifndef LUMIVOX_OCTREE
#define LUMIVOX_OCTREE
#include "toolkit/bit_tree.glsl"

const uint kTagged = 0xfffffffeu;  // in place of children: they are to be made

struct OctreeNode {
  uint children;  // the first of them; kNone: it has none
  uint brick;     // kNone: there is nothing in it
  uint neighbourX, neighbourY, neighbourZ;  // nodes of the same depth at higher x, y, z; kNone: nothing is there
};

layout(std140, binding = 3) uniform Octree {
  int octreeDepth;      // of the leaves
  int octreePoolShift;  // the pool has 2 to the power of this bricks along x and along y
  int octreeRanked;     // 1: there are ranks (octree_ranks.glsl)
  int octreeSide;       // voxels along a brick: 3, or 2 of its own
};
#ifdef OCTREE_BUILD
#define OCTREE_ACCESS
#else
#define OCTREE_ACCESS readonly
#endif
layout(std430, binding = 9) OCTREE_ACCESS buffer OctreeNodes { OctreeNode octreeNodes[]; };

// The node of a depth at a place, counted in nodes of that depth, found from the root (kd-restart;
// thesis 004, Listing 4.17). kNone: the tree does not reach so far there.
uint nodeAt(ivec3 place, int depth) {
  uint node = 0u;
  for (int below = depth - 1; below >= 0; --below) {
    uint tile = octreeNodes[node].children;
    if (tile >= kTagged) return kNone;
    ivec3 side = place >> below & 1;
    node = tile + uint(side.x | side.y << 1 | side.z << 2);
  }
  return node;
}

// kNone: nothing is there.
uint brickAt(ivec3 place, int depth) {
  uint node = nodeAt(place, depth);
  return node == kNone ? kNone : octreeNodes[node].brick;
}

// The first of the texels of a brick in a pool that has 2 to the power of `shift` of them along x and along y.
ivec3 texelIn(int shift, uint brick) {
  uint row = (1u << shift) - 1u;
  return octreeSide * ivec3(brick & row, brick >> shift & row, brick >> 2 * shift);
}
ivec3 texelOf(uint brick) { return texelIn(octreePoolShift, brick); }

// Where voxels have six faces, the pool has six bricks for each, one behind the other: by the outward normals +x, -x, +y, -y, +z and -z.
const uint kBrickFaces = 6u;
uint brickOfFace(uint brick, uint face) { return kBrickFaces * brick + face; }

#endif
