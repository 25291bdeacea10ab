// A sparse voxel octree, Listing 4.16. Depth 0 is the root, `octreeDepth` that of the leaves. The eight children of a node are a tile of 2 x 2 x 2
// nodes, one behind the other; the root has a tile to itself. Node n of a depth has a brick of the voxels 2n to 2n + 2 of that depth along each
// axis, which shares its sides with its neighbours', so that trilinear reading never leaves a brick.
// C++ side: OctreeNodes in techniques/thesis_cone_tracing/octree_ports.h.
#ifndef LUMIVOX_THESIS_OCTREE
#define LUMIVOX_THESIS_OCTREE

const uint kNone = 0xffffffffu;
const uint kTagged = 0xfffffffeu;  // in place of children: they are to be made (Listing 4.19)
const uint kBrickVoxels = 27u;

struct OctreeNode {
  uint children;  // the first of them; kNone: it has none
  uint brick;     // kNone: there is nothing in it
  uint neighbourX, neighbourY, neighbourZ;  // nodes of the same depth at higher x, y, z; kNone: nothing is there
};

layout(std140, binding = 3) uniform Octree {
  int octreeDepth;      // of the leaves
  int octreePoolShift;  // the pool has 2 to the power of this bricks along x and along y
  int octreeAtCorners;  // 1: voxels lie at the corners of nodes; 0: in the eighths of leaves
};
#ifdef OCTREE_BUILD
#define OCTREE_ACCESS
#else
#define OCTREE_ACCESS readonly
#endif
layout(std430, binding = 9) OCTREE_ACCESS buffer OctreeNodes { OctreeNode octreeNodes[]; };

// The node of a depth at a place, counted in nodes of that depth, found from the root (kd-restart, Listing 4.17). kNone: the tree does not
// reach so far there.
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

// The first of the texels of a brick in the pool.
ivec3 texelOf(uint brick) {
  uint row = (1u << octreePoolShift) - 1u;
  return 3 * ivec3(brick & row, brick >> octreePoolShift & row, brick >> 2 * octreePoolShift);
}

#endif
