#version 450
// The finest level of the node map: the leaf that each photon lies in (Crassin et al. 2011, Sec. 6).
layout(local_size_x = 64) in;
#include "octree_photons.glsl"

layout(std140, binding = 0) uniform Photons {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 mapSize;    // texels, layers
};
layout(binding = 0) uniform sampler2DArray photonPosition;
layout(binding = 0, r32ui) uniform writeonly uimage2DArray nodeMap;

void main() {
  uint index = listIndex();
  if (index >= uint(mapSize.x * mapSize.y * mapSize.z)) return;
  ivec3 texel = ivec3(int(index) % mapSize.x, int(index) / mapSize.x % mapSize.y, int(index) / (mapSize.x * mapSize.y));
  vec4 position = texelFetch(photonPosition, texel, 0);
  uint code = 0u;
  if (position.w > 0.0) {
    ivec3 voxel = ivec3(floor((position.xyz - gridLow) / voxelSize));
    if (all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, ivec3(2 << octreeDepth)))) {
      code = codeOf(voxel >> 1, octreeDepth);
      if (brickOfCode(code) == kNone) code = 0u;
    }
  }
  imageStore(nodeMap, texel, uvec4(code));
}
