// The positions whose light a surface point reads, and their weights: Mavridis & Papaioannou 2011, Sec. 3.4, Eq. 5. The point moves along
// its normal. The weight is the cosine between the normal and the direction from the surface point to the position, so that positions
// behind the surface do not count. The equation leaves the angle undefined; this is what Fig. 2 shows.
#ifndef LUMIVOX_NEIGHBOURS
#define LUMIVOX_NEIGHBOURS
#include "volume.glsl"

const int kSix = 0, kEight = 1, kOwn = 2, kTrilinear = 3;

layout(constant_id = 10) const int voxels = 0;   // kSix to kTrilinear
layout(constant_id = 11) const int filtered = 1; // 0: neighbours are whole voxels

layout(std140, binding = 2) uniform Neighbours { float shift; };  // voxels

const int kMostNeighbours = 8;
int neighbourCount() { return voxels == kSix ? 6 : voxels == kEight ? 8 : 1; }
// Whether positions are filtered between voxel centres; otherwise they are voxel centres.
bool isFiltered() { return voxels == kTrilinear || (filtered != 0 && voxels != kOwn); }

// The weight of neighbour i, and its position.
float neighbour(int i, vec3 surface, vec3 normal, out vec3 place) {
  precise vec3 shifted = surface + shift * normal;  // equal, to the bit, where voxels are marked and where they are read
  if (voxels == kTrilinear) {
    place = shifted;
    return 1.0;
  }
  if (voxels == kOwn) {
    place = floor(surface) + 0.5;
    return 1.0;
  }
  if (voxels == kSix) {
    place = filtered != 0 ? shifted : floor(shifted) + 0.5;
    place[i >> 1] += (i & 1) != 0 ? 1.0 : -1.0;
  } else {
    place = filtered != 0 ? shifted - 0.5 : floor(shifted - 0.5) + 0.5;
    place += vec3(i & 1, i >> 1 & 1, i >> 2);
  }
  vec3 way = place - surface;
  float apart = length(way);
  return apart > 0.0 ? max(dot(normal, way) / apart, 0.0) : 0.0;
}

#endif
