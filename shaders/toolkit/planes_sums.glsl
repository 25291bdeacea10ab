// Sums over a group of fragments, as integers: of the normals, of the places from the voxel's centre, and of the shares. The share of a
// fragment is one over the number of fragments in the voxel.
#include "common/integer_mean.glsl"
const uint kPlaneSums = 7u;
