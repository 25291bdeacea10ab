// A sparse voxel octree, Listing 4.16. Depth 0 is the root, `octreeDepth` the depth of the leaves. The eight children of a node are a tile
// of 2 x 2 x 2 consecutive nodes; the root has a tile of its own. The brick of node n of a depth has the voxels 2n to 2n + 2 of that depth
// along each axis. Bricks share the voxels of their sides with their neighbours, so that a trilinear read never leaves a brick.
// C++ side: OctreeNodes in techniques/thesis_cone_tracing/octree_ports.h.
#ifndef LUMIVOX_THESIS_OCTREE
#define LUMIVOX_THESIS_OCTREE

const uint kNone = 0xffffffffu;
const uint kTagged = 0xfffffffeu;  // instead of `children`: the node is to be subdivided (Listing 4.19)
const uint kBrickVoxels = 27u;

struct OctreeNode {
  uint children;  // index of the first child; kNone: no children
  uint brick;     // kNone: an empty node
  uint neighbourX, neighbourY, neighbourZ;  // nodes of the same depth at higher x, y, z; kNone: empty
};

layout(std140, binding = 3) uniform Octree {
  int octreeDepth;      // of the leaves
  int octreePoolShift;  // the pool has 2^octreePoolShift bricks along x and along y
  int octreeAtCorners;  // 1: voxels lie at the corners of nodes; 0: in the octants of leaves
};
#ifdef OCTREE_BUILD
#define OCTREE_ACCESS
#else
#define OCTREE_ACCESS readonly
#endif
layout(std430, binding = 9) OCTREE_ACCESS buffer OctreeNodes { OctreeNode octreeNodes[]; };

// The node of a depth at a position, in nodes of that depth, found by descending from the root (kd-restart, Listing 4.17). kNone: the tree
// has no node of that depth there.
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

// The brick of the node of a depth at a position; kNone: empty.
uint brickAt(ivec3 place, int depth) {
  uint node = nodeAt(place, depth);
  return node == kNone ? kNone : octreeNodes[node].brick;
}

// The first texel of a brick in the pool.
ivec3 texelOf(uint brick) {
  uint row = (1u << octreePoolShift) - 1u;
  return 3 * ivec3(brick & row, brick >> octreePoolShift & row, brick >> 2 * octreePoolShift);
}

#endif
