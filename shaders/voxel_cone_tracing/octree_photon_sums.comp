#version 450
// The average of what the photons of one light in a voxel reflect, by the areas that they stand for: Crassin et al. 2011, Sec. 6; thesis 004, Sec. 4.2.2,
// Listing 4.24. Deviates from that listing: an average that does not depend on the order (common/integer_mean.glsl), of what the photons
// reflect themselves in place of the average surface of the voxel.
#pragma lumivox axis STAGE count add
layout(local_size_x = 64) in;
#include "octree_photons.glsl"
#include "common/constants.glsl"
#include "common/integer_mean.glsl"

layout(std140, binding = 0) uniform PhotonsOfLight {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 mapSize;    // texels, layers
  int light;        // whose photons count
};
layout(binding = 0) uniform sampler2DArray photonPosition;
layout(binding = 1) uniform sampler2DArray photonNormal;
layout(binding = 2) uniform sampler2DArray photonFlux;
layout(binding = 3) uniform usampler2DArray nodes;
layout(std430, binding = 4) buffer Sums { PhotonSums sums[]; };

void main() {
  uint index = listIndex();
  if (index >= uint(mapSize.x * mapSize.y * mapSize.z)) return;
  ivec3 texel = ivec3(int(index) % mapSize.x, int(index) / mapSize.x % mapSize.y, int(index) / (mapSize.x * mapSize.y));
  uint code = texelFetch(nodes, texel, 0).r;
  float area = texelFetch(photonNormal, texel, 0).w;
  vec4 flux = texelFetch(photonFlux, texel, 0);
  if (code == 0u || !(area > 0.0) || int(flux.w) != light) return;
  ivec3 own = ivec3(floor((texelFetch(photonPosition, texel, 0).xyz - gridLow) / voxelSize)) & 1;
  uint place = 8u * (brickOfCode(code) - octreeLevels[octreeDepth].firstBrick) + uint(own.x | own.y << 1 | own.z << 2);
  // A Lambert surface that reflects a flux from an area has the radiance flux / (pi area).
  vec3 radiance = max(flux.rgb, 0.0) / (kPi * area);
#if STAGE == STAGE_COUNT
  atomicAdd(sums[place].photons, 1u);
  atomicMax(sums[place].brightest, floatBitsToUint(max(radiance.r, max(radiance.g, radiance.b))));
  atomicMax(sums[place].largestArea, floatBitsToUint(area));
#else
  float brightest = uintBitsToFloat(sums[place].brightest);
  float weight = area / uintBitsToFloat(sums[place].largestArea) / float(sums[place].photons);
  uvec4 addend = shareOf(vec4(brightest > 0.0 ? min(radiance / brightest, 1.0) : vec3(0.0), 1.0) * weight);
  atomicAdd(sums[place].red, addend.r);
  atomicAdd(sums[place].green, addend.g);
  atomicAdd(sums[place].blue, addend.b);
  atomicAdd(sums[place].weight, addend.a);
#endif
}
