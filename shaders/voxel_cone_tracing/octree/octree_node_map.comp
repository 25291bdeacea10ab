#version 450
// The finest level of the node map: the voxel that contains each photon, encoded as a node below its leaf (Crassin et al. 2011, Sec. 6).
layout(local_size_x = 64) in;
#include "octree_photons.glsl"

layout(std140, binding = 0) uniform Photons {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 mapSize;    // texels, layers
};
layout(binding = 0) uniform sampler2DArray photonPosition;
layout(binding = 1) uniform sampler2DArray photonNormal;
layout(binding = 2) uniform sampler3D pool;
layout(binding = 0, r32ui) uniform writeonly uimage2DArray nodeMap;

// Code of the voxel at a point; 0: the voxel is empty.
uint voxelAt(vec3 at) {
  ivec3 voxel = ivec3(floor(at));
  if (any(lessThan(voxel, ivec3(0))) || any(greaterThanEqual(voxel, ivec3(2 << octreeDepth)))) return 0u;
  uint brick = brickOfCode(codeOf(voxel >> 1, octreeDepth));
  if (brick == kNone || texelFetch(pool, texelOf(brick) + (voxel & 1), 0).a == 0.0) return 0u;
  return codeOf(voxel, octreeDepth + 1);
}

void main() {
  uint index = listIndex();
  if (index >= uint(mapSize.x * mapSize.y * mapSize.z)) return;
  ivec3 texel = ivec3(int(index) % mapSize.x, int(index) / mapSize.x % mapSize.y, int(index) / (mapSize.x * mapSize.y));
  vec4 position = texelFetch(photonPosition, texel, 0);
  uint code = 0u;
  if (position.w > 0.0) {
    // The voxelizer puts a surface on the face between two voxels into one or both of them, and rounding may put the photon into the other.
    // The voxel in front of the surface, which other surfaces see, is tried first.
    const float kRounding = 0.01;  // voxels
    vec3 at = (position.xyz - gridLow) / voxelSize, aside = kRounding * texelFetch(photonNormal, texel, 0).xyz;
    code = voxelAt(at + aside);
    if (code == 0u) code = voxelAt(at);
    if (code == 0u) code = voxelAt(at - aside);
  }
  imageStore(nodeMap, texel, uvec4(code));
}
