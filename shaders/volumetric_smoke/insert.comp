#version 450
// Thesis 004, Sec. 4.5, Listing 4.50: every particle adds its mass to the voxels of the grid. Deviates: a particle is a cloud instead of a
// point, and distributes its mass over the free voxels of the cloud. With `counts` it adds one to its voxel, as published. Integer sums
// have the same bits in any order.
#pragma lumivox axis SPACE 0 1
#pragma lumivox axis DEPOSIT clouds counts
layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std140, binding = 0) uniform Parameters {
  vec3 source;  // m
  uint count;
  vec3 gridLow;  // m
  float voxelSize;
  ivec3 resolution;
  float radius;  // of a cloud, m; at least a voxel
  vec3 spaceLow;  // m
  float spaceVoxelSize;
};
layout(std430, binding = 0) readonly buffer Offsets { float offsets[]; };  // x, y, z per particle
layout(binding = 0, r32ui) uniform uimage3D lowWords;
layout(binding = 1, r32ui) uniform uimage3D highWords;
#if SPACE
layout(binding = 0) uniform sampler3D occupancy;
#endif

const uint kUnits = 16777216u;  // mass of one particle, 2^24: shares of it are exact in single precision

bool isFree(ivec3 voxel) {
#if SPACE
  ivec3 place = ivec3(floor((gridLow + (vec3(voxel) + 0.5) * voxelSize - spaceLow) / spaceVoxelSize));
  if (any(lessThan(place, ivec3(0))) || any(greaterThanEqual(place, textureSize(occupancy, 0)))) return true;
  return texelFetch(occupancy, place, 0).r == 0.0;
#else
  return true;
#endif
}

// (1 - q^2)^3, see framework/include/lumivox/scene/medium.h.
float cloud(ivec3 voxel, vec3 centre) {
  vec3 path = ((vec3(voxel) + 0.5) * voxelSize - centre) / radius;
  float inside = max(1.0 - dot(path, path), 0.0);
  return inside * inside * inside;
}

// 64-bit sums: the addition that overflows the low word adds the carry to the high word.
void add(ivec3 voxel, uint units) {
  uint before = imageAtomicAdd(lowWords, voxel, units);
  if (before + units < before) imageAtomicAdd(highWords, voxel, 1u);
}

void main() {
  uint index = listIndex();
  if (index >= count) return;
  vec3 offset = vec3(offsets[3u * index], offsets[3u * index + 1u], offsets[3u * index + 2u]);
  vec3 centre = source + offset - gridLow;
#if DEPOSIT == DEPOSIT_COUNTS
  ivec3 voxel = clamp(ivec3(floor(centre / voxelSize)), ivec3(0), resolution - 1);
  if (isFree(voxel)) add(voxel, kUnits);
#else
  ivec3 first = clamp(ivec3(floor((centre - radius) / voxelSize)), ivec3(0), resolution - 1);
  ivec3 last = clamp(ivec3(floor((centre + radius) / voxelSize)), ivec3(0), resolution - 1);

  float sum = 0.0, most = 0.0;
  ivec3 densest = ivec3(0);
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        ivec3 voxel = ivec3(x, y, z);
        float weight = cloud(voxel, centre);
        if (weight <= 0.0 || !isFree(voxel)) continue;
        sum += weight;
        if (weight > most) {
          most = weight;
          densest = voxel;
        }
      }
  if (most <= 0.0) return;  // no free voxel: inside solid geometry

  // The remainder of rounding goes to the densest voxel, so that no mass is lost.
  uint given = 0u;
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        ivec3 voxel = ivec3(x, y, z);
        float weight = cloud(voxel, centre);
        if (weight <= 0.0 || voxel == densest || !isFree(voxel)) continue;
        uint units = uint(float(kUnits) * (weight / sum));
        if (units > 0u) add(voxel, units);
        given += units;
      }
  add(densest, kUnits - given);
#endif
}
