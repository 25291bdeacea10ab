#version 450
// Photons relight the mean colour of their voxel by the cosine between its mean normal and the light, and are averaged (Listing 4.24).
// The colour of the light, which the listing leaves open, is its irradiance over pi, so that a Lambertian surface has the radiance that it
// reflects. The averages include voxels of neighbouring leaves: next to empty space, the normal turns towards (-1, -1, -1).
layout(local_size_x = 64) in;
#include "common/lights.glsl"
#include "octree_levels.glsl"
#include "octree_sums.glsl"

layout(std140, binding = 0) uniform Photons {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 mapSize;    // texels, layers
};
layout(binding = 0) uniform sampler2DArray photonPosition;
layout(binding = 1) uniform sampler2DArray photonNormal;
layout(binding = 2) uniform sampler2DArray photonFlux;
layout(binding = 3) uniform sampler3D pool;
layout(binding = 4) uniform sampler3D colours;
layout(binding = 5) uniform sampler3D normals;

// The leaf's brick and the voxel in it at a point, in voxels; false: the voxel is empty.
bool voxelAt(vec3 at, out uint brick, out ivec3 own) {
  ivec3 voxel = ivec3(floor(at));
  if (any(lessThan(voxel, ivec3(0))) || any(greaterThanEqual(voxel, ivec3(2 << octreeDepth)))) return false;
  own = voxel & 1;
  brick = brickAt(voxel >> 1, octreeDepth);
  return brick != kNone && texelFetch(pool, texelOf(brick) + 2 * own, 0).a > 0.0;
}

void main() {
  uint index = listIndex();
  if (index >= uint(mapSize.x * mapSize.y * mapSize.z) || octreeLevels[octreeDepth].bricks == 0u) return;
  ivec3 texel = ivec3(int(index) % mapSize.x, int(index) / mapSize.x % mapSize.y, int(index) / (mapSize.x * mapSize.y));
  vec4 position = texelFetch(photonPosition, texel, 0);
  if (!(position.w > 0.0)) return;
  // The voxelizer puts a surface on the face between two voxels into one or both of them, and rounding may put the photon into the other.
  // The voxel in front of the surface, which other surfaces see, is tried first.
  const float kRounding = 0.01;  // voxels
  vec3 at = (position.xyz - gridLow) / voxelSize, aside = kRounding * texelFetch(photonNormal, texel, 0).xyz;
  uint brick;
  ivec3 own;
  if (!voxelAt(at + aside, brick, own) && !voxelAt(at, brick, own) && !voxelAt(at - aside, brick, own)) return;
  ivec3 corner = texelOf(brick) + 2 * own;
  vec3 normal = 2.0 * texelFetch(normals, corner, 0).xyz - 1.0, toLight;
  vec3 arriving = arrivingIrradiance(lights[int(texelFetch(photonFlux, texel, 0).w)], position.xyz, toLight);
  vec3 radiance = texelFetch(colours, corner, 0).rgb * arriving / kPi * max(dot(normal, toLight) / max(length(normal), 1e-6), 0.0);
  uint place = sumsOf(brick, uint(own.x | own.y << 1 | own.z << 2));
  if (stage == kCount)
    countIn(place, radiance);
  else
    addTo(place, unitsOf(place, radiance) / float(sums[place].items));
}
