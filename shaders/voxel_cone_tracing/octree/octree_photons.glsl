// Photons of a reflective shadow map in an octree: Crassin et al. 2011, Sec. 6; thesis 004, Sec. 3.1.3 and 4.2.2.
// C++ side: techniques/voxel_cone_tracing/octree/octree_splat.cpp.
#ifndef LUMIVOX_OCTREE_PHOTONS
#define LUMIVOX_OCTREE_PHOTONS
#include "octree_levels.glsl"
#include "octree_ranks.glsl"

// The photons of one voxel.
struct PhotonSums {
  uint photons;
  uint brightest, largestArea;  // bits of non-negative floats, which order like the floats
  uint red, green, blue, weight;  // shares of averages, in units of kFixedPoint
};

// Code of a node, its path from the root: a 1, then three bits per depth. 0: no node.
uint codeOf(ivec3 place, int depth) { return 1u << 3 * depth | mortonOf(place); }
int depthOf(uint code) { return findMSB(code) / 3; }
uint ancestorOf(uint code, int depth) { return code >> 3 * (depthOf(code) - depth); }

// The deepest node that contains both nodes; it may be one of them.
uint commonAncestor(uint a, uint b) {
  if (a == 0u || b == 0u) return a | b;
  int depth = min(depthOf(a), depthOf(b));
  a = ancestorOf(a, depth);
  uint differing = a ^ ancestorOf(b, depth);
  return differing == 0u ? a : a >> 3 * (findMSB(differing) / 3 + 1);
}

// The brick of a node; kNone if there is no such node, or if the tree is empty because it had too little room.
uint brickOfCode(uint code) {
  if (octreeLevels[octreeDepth].bricks == 0u) return kNone;
  int depth = depthOf(code);
  return rankedBrick(code - (1u << 3 * depth), depth);
}

#endif
