// Occupied voxels that reflect light of the frame before: each side of such a surface reads one free voxel in front of it.
#ifndef LUMIVOX_FRONT
#define LUMIVOX_FRONT
#include "volume.glsl"
layout(binding = 0) uniform sampler3D opacity;

struct Surface {
  uint voxel;
  uint fronts;  // 8 bits for each side, that of the mean normal first: the way to its front, or kNoFront; or kNoNormal
};
const uint kNoFront = 255u;         // no free voxel lies in front of the side
const uint kNoNormal = 0xffffffffu; // the mean normals cancel out

uint packWay(ivec3 way) { return uint(way.x + 1 + 3 * (way.y + 1) + 9 * (way.z + 1)); }
ivec3 unpackWay(uint code) { return ivec3(code % 3u, code / 3u % 3u, code / 9u) - 1; }

bool isFree(ivec3 voxel) { return inVolume(voxel) == voxel && texelFetch(opacity, voxel, 0).r <= occupied; }

// Which free voxels count.
#ifndef COUNTS
#define COUNTS(voxel) true
#endif

// The way to the nearest voxel in the direction of the normal, else to the next one to it of the seven on that side. Those are free and
// count, or, `apart` voxels away, lie behind a free one. False if there is none.
bool wayToFront(ivec3 voxel, vec3 normal, int apart, out ivec3 nearest) {
  vec3 size = abs(normal);
  nearest = ivec3(floor(normal / max(max(size.x, size.y), size.z) + 0.5));
  if (apart == 1 && isFree(voxel + nearest) && COUNTS(voxel + nearest)) return true;
  ivec3 side = ivec3(mix(vec3(-1.0), vec3(1.0), greaterThanEqual(normal, vec3(0.0))));
  float most = 0.0;
  for (int i = 1; i < 8; ++i) {
    ivec3 axes = ivec3(i & 1, i >> 1 & 1, i >> 2), way = side * axes;
    float along = dot(size, vec3(axes)) * inversesqrt(float(axes.x + axes.y + axes.z));
    if (along <= most + 1e-3 || !isFree(voxel + way)) continue;  // of directions that differ by less the first one wins
    if (apart > 1 && !isFree(voxel + apart * way) || !COUNTS(voxel + apart * way)) continue;
    most = along;
    nearest = way;
  }
  return most > 0.0;
}

#endif
