// What the voxels of Doghramachi 2013 keep of their surfaces (thesis 004 Sec. 4.3.1, Listings 4.27 to 4.29), as integers so that the order
// does not matter: a mean and a most contrasting albedo, and for each of four groups of normals, those nearest to one face of a
// tetrahedron, the mean normal and position and the covered parts. Deviates from the published atomicMax of normals packed behind their
// closeness to the face: the mean depends on all surfaces.
#include "parts.glsl"

const int kGroups = 4;
const int kWeight = 0, kAlbedo = 1, kWinner = 4, kGroup = 5;                      // words of a voxel
const int kGroupWeight = 0, kGroupNormal = 1, kGroupPosition = 4, kGroupParts = 7;  // words of a group
const int kBesideParts = 16;  // first bit of the parts that lie in a neighbour, behind a wall that was moved
const int kWordsOfGroup = 8, kWordsOfVoxel = kGroup + kGroups * kWordsOfGroup;
layout(std430, binding = 3) buffer Voxels { uint voxels[]; };

// Listing 4.28: directions of the faces of a regular tetrahedron.
const vec3 kTetrahedron[4] = vec3[4](vec3(0.0, -0.57735026, 0.81649661), vec3(0.0, -0.57735026, -0.81649661),
                                     vec3(-0.81649661, 0.57735026, 0.0), vec3(0.81649661, 0.57735026, 0.0));

int groupOf(vec3 normal) {
  int best = 0;
  for (int i = 1; i < kGroups; ++i)
    if (dot(normal, kTetrahedron[i]) > dot(normal, kTetrahedron[best])) best = i;
  return best;
}

// Means are sums of signed shares: value * 2^30 / weight, |value| at most 1.
const float kShare = 0.5 * kFixedPoint;
uint shareOf(float value, float weight) { return uint(int(round(value * (kShare / weight)))); }
vec3 meanOf(uint x, uint y, uint z) { return vec3(int(x), int(y), int(z)) / kShare; }

// Positions are kept relative to the middle of their cell; a surface lies at most a cell away from it.
const float kPositionRange = 2.0;  // cells
