// The surface data of Doghramachi 2013's voxels (thesis 004 Sec. 4.3.1, Listings 4.27 to 4.29), as integers so that the order does not
// matter: a mean and a most contrasting albedo, and for each of four groups of normals, those nearest to one face of a tetrahedron, the
// mean normal and position and the covered parts. Deviates from the published atomic maximum (packed_voxels.glsl): a mean depends on all
// surfaces.
#include "common/integer_mean.glsl"
#include "parts.glsl"
#include "tetrahedron.glsl"

const int kGroups = 4;
const int kBesideParts = 16;  // first bit of the parts that lie in a neighbour, behind a wall that was moved
struct SurfaceGroup {
  uint weight;
  int normal[3], position[3];  // means, as signed shares
  uint parts;                  // a bit each
};
struct LitVoxel {
  uint weight;
  int albedo[3];  // mean, as signed shares
  uint winner;
  SurfaceGroup groups[kGroups];
};
layout(std430, binding = 3) buffer Voxels { LitVoxel voxels[]; };

// Positions are kept relative to the middle of their cell; a surface lies at most a cell away from it.
const float kPositionRange = 2.0;  // cells
