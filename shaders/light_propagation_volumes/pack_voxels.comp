#version 450
// Stores surfaces in voxels as printed (thesis 004 Listings 4.27 to 4.29): the front of each surface, in the voxel that contains it; the
// largest word wins.
#include "packed_voxels.glsl"

layout(local_size_x = 64) in;
#include "common/fragments.glsl"

layout(std140, binding = 0) uniform Parameters {
  vec3 listLow;      // low corner of the grid of the fragments, m
  float listVoxel;   // m
};
#include "cell_grid.glsl"
layout(std430, binding = 3) buffer Words { PackedVoxel words[]; };

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  vec3 position = (listLow + (vec3(unpackVoxel(fragment.voxel)) + unpackOffset(fragment.offset)) * listVoxel - gridLow) / cellSize;
  ivec3 cell = ivec3(floor(position));
  if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, resolution))) return;
  int voxel = (cell.z * resolution.y + cell.y) * resolution.x + cell.x;
  vec3 albedo = vec3(unpackHalf2x16(fragment.albedoRg), unpackHalf2x16(fragment.albedoBCoverage).x);
  vec3 normal = unpackNormal(fragment.normal);
  int face = groupOf(normal);
  atomicMax(words[voxel].albedo, packAlbedo(albedo));
  atomicMax(words[voxel].directions[face], packDirection(normal, face));
}
