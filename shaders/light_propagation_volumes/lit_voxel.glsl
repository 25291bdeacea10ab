// The surface data of Doghramachi 2013's voxels (thesis 004 Sec. 4.3.1, Listings 4.27 to 4.29), as integers, so that the order does not
// matter: the mean albedo and the albedo with the largest contrast. Normals are in four groups by the nearest face of a tetrahedron; each
// group has its mean normal, mean position and covered parts. Deviates from the published atomic maximum (packed_voxels.glsl): a mean
// depends on all surfaces.
#include "common/integer_mean.glsl"
#include "parts.glsl"
#include "tetrahedron.glsl"

const int kGroups = 4;
const int kBesideParts = 16;  // first bit of parts that lie in a neighbouring cell, behind a moved wall's plane, but count here
struct SurfaceGroup {
  uint weight;
  int normal[3], position[3];  // means, as signed shares
  uint parts;                  // one bit per part
};
struct LitVoxel {
  uint weight;
  int albedo[3];  // mean, as signed shares
  uint winner;
  SurfaceGroup groups[kGroups];
};
layout(std430, binding = 3) buffer Voxels { LitVoxel voxels[]; };

// Range of positions relative to the centre of their cell; no surface is farther away than a cell.
const float kPositionRange = 2.0;  // cells
