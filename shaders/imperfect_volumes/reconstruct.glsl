// The radiance that arrives at a surface point, interpolated from the voxels around it (Mavridis & Papaioannou 2011, Sec. 3.4, Eq. 5). With
// two bands its irradiance also counts light from behind: L (1/4 + 1/2 cos theta) over the whole sphere instead of max(0, cos theta).
#include "neighbours.glsl"
#include "surface_sides.glsl"

layout(constant_id = 13) const int onlyFree = 0;  // 1: only free voxels visible from the surface count; if there is none, all

// VOLUMES 1: a single volume for values without colour.
#if VOLUMES == 3
layout(binding = 5) uniform sampler3D red;
layout(binding = 6) uniform sampler3D green;
layout(binding = 7) uniform sampler3D blue;
#else
layout(binding = 5) uniform sampler3D red;
#endif
layout(binding = 8) uniform sampler3D opacityAround;
layout(binding = 9) uniform sampler3D normalsAround;

struct Arriving {
  vec4 volumes[VOLUMES];
};

void addVoxel(inout Arriving sum, ivec3 voxel, float weight) {
  sum.volumes[0] += weight * texelFetch(red, voxel, 0);
#if VOLUMES == 3
  sum.volumes[1] += weight * texelFetch(green, voxel, 0);
  sum.volumes[2] += weight * texelFetch(blue, voxel, 0);
#endif
}

bool isFree(ivec3 voxel) { return texelFetch(opacityAround, inVolume(voxel), 0).r <= occupied; }

// Cosines that differ by less count as equal, and the first direction wins, so that rounding does not decide.
const float kTie = 1e-3;

// The free voxel in front of a surface point: its own voxel, or of the 26 voxels around it the free one closest to the direction of the
// point's normal plus the mean normal in its voxel, so that along an edge it lies in front of both walls. False if there is none.
bool voxelBefore(vec3 surface, vec3 normal, out ivec3 before) {
  before = inVolume(ivec3(floor(surface)));
  if (isFree(before)) return true;
  ivec3 own = before;
  vec3 mean = texelFetch(normalsAround, own, 0).xyz;
  float apart = length(mean);
  if (apart > kLeastNormal) normal = normalize(normal + (dot(mean, normal) < 0.0 ? -mean : mean) / apart);
  float most = 0.0;
  for (int i = 0; i < 27; ++i) {
    ivec3 way = ivec3(i % 3, i / 3 % 3, i / 9) - 1;
    float along = i != 13 ? dot(normal, normalize(vec3(way))) : 0.0;
    if (along <= most + kTie || inVolume(own + way) != own + way || !isFree(own + way)) continue;
    most = along;
    before = own + way;
  }
  return most > 0.0;
}

// Whether a voxel is free and visible from the voxel `before`, at most three voxels away along each axis, as with a shift of at most one
// voxel. Adjacent voxels always see each other.
bool isOpen(ivec3 voxel, ivec3 before) {
  if (!isFree(voxel)) return false;
  ivec3 apart = abs(voxel - before);
  if (max(max(apart.x, apart.y), apart.z) < 2) return true;
  vec3 from = vec3(before) + 0.5, way = vec3(voxel - before);
  return isFree(ivec3(floor(from + 0.4 * way))) && isFree(ivec3(floor(from + 0.6 * way)));
}

// Adds the value at a position and returns its weight. With `free`, only voxels that are open to `before` count.
float addPlace(inout Arriving sum, vec3 place, float weight, bool free, ivec3 before) {
  if (!isFiltered()) {
    ivec3 voxel = inVolume(ivec3(floor(place)));
    if (free && !isOpen(voxel, before)) return 0.0;
    addVoxel(sum, voxel, weight);
    return weight;
  }
  if (!free) {
    vec3 texcoord = place / vec3(resolution);
    sum.volumes[0] += weight * textureLod(red, texcoord, 0.0);
#if VOLUMES == 3
    sum.volumes[1] += weight * textureLod(green, texcoord, 0.0);
    sum.volumes[2] += weight * textureLod(blue, texcoord, 0.0);
#endif
    return weight;
  }
  ivec3 low = ivec3(floor(place - 0.5));
  vec3 part = place - 0.5 - vec3(low);
  float all = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    ivec3 high = ivec3(corner & 1, corner >> 1 & 1, corner >> 2), voxel = inVolume(low + high);
    if (!isOpen(voxel, before)) continue;
    vec3 parts = mix(1.0 - part, part, vec3(high));
    float share = weight * parts.x * parts.y * parts.z;
    addVoxel(sum, voxel, share);
    all += share;
  }
  return all;
}

// Eq. 5. `surface` is in voxels.
Arriving arrivingAt(vec3 surface, vec3 normal) {
  Arriving sum;
  float weights = 0.0;
  ivec3 before = ivec3(0);
  for (int attempt = onlyFree != 0 && voxelBefore(surface, normal, before) ? 0 : 1; attempt < 2 && weights <= 0.0; ++attempt) {
    for (int v = 0; v < VOLUMES; ++v) sum.volumes[v] = vec4(0.0);
    for (int i = 0; i < neighbourCount(); ++i) {
      vec3 place;
      float weight = neighbour(i, surface, normal, place);
      if (weight > 0.0) weights += addPlace(sum, place, weight, attempt == 0, before);
    }
  }
  for (int v = 0; v < VOLUMES; ++v) sum.volumes[v] *= weights > 0.0 ? 1.0 / weights : 0.0;
  return sum;
}
