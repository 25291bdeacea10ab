// Sums over a group of fragments, as integers: of the normals, of the places from the voxel's centre, and of the shares. The share of a
// fragment is one over the number of fragments in the voxel.
#include "common/integer_mean.glsl"
struct PlaneSum {  // two a slot
  int normal[3], place[3];
  int share;
};
