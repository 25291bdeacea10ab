// What the voxels of Doghramachi 2013 keep of their surfaces (thesis 004 Sec. 4.3.1, Listings 4.27 to 4.29), as integers so that the order
// does not matter: a mean and a most contrasting albedo, and for each of four groups of normals, those nearest to one face of a
// tetrahedron, the mean normal and position and the covered parts. Deviates from the published atomic maximum (packed_voxels.glsl): a mean
// depends on all surfaces.
#include "parts.glsl"
#include "tetrahedron.glsl"

const int kGroups = 4;
const int kWeight = 0, kAlbedo = 1, kWinner = 4, kGroup = 5;                      // words of a voxel
const int kGroupWeight = 0, kGroupNormal = 1, kGroupPosition = 4, kGroupParts = 7;  // words of a group
const int kBesideParts = 16;  // first bit of the parts that lie in a neighbour, behind a wall that was moved
const int kWordsOfGroup = 8, kWordsOfVoxel = kGroup + kGroups * kWordsOfGroup;
layout(std430, binding = 3) buffer Voxels { uint voxels[]; };

// Means are sums of signed shares: value * 2^30 / weight, |value| at most 1.
const float kShare = 0.5 * kFixedPoint;
uint shareOf(float value, float weight) { return uint(int(round(value * (kShare / weight)))); }
vec3 meanOf(uint x, uint y, uint z) { return vec3(int(x), int(y), int(z)) / kShare; }

// Positions are kept relative to the middle of their cell; a surface lies at most a cell away from it.
const float kPositionRange = 2.0;  // cells
