#version 450
// Photons relight the mean colour of their voxel, whose mean normal faces the light more or less, and are averaged: thesis 004, Sec. 4.2.2,
// Listing 4.24 as printed. Its average in 8 bits depends on the order; here it does not (common/integer_mean.glsl).
// The colour of the light, which the listing leaves open, is its irradiance over pi, so that a Lambert surface has the radiance that it
// reflects. What is averaged holds the voxels of neighbours' leaves too: of half a surface beside nothing the normal turns towards
// (-1, -1, -1).
#pragma lumivox axis STAGE count add
layout(local_size_x = 64) in;
#include "octree_photons.glsl"
#include "common/integer_mean.glsl"
#include "common/lights.glsl"

layout(std140, binding = 0) uniform Relit {
  ivec3 mapSize;  // texels, layers
};
layout(binding = 0) uniform sampler2DArray photonPosition;
layout(binding = 1) uniform sampler3D colours;
layout(binding = 2) uniform sampler2DArray photonFlux;
layout(binding = 3) uniform usampler2DArray nodes;
layout(binding = 4) uniform sampler3D normals;
layout(std430, binding = 4) buffer Sums { PhotonSums sums[]; };

void main() {
  uint index = listIndex();
  if (index >= uint(mapSize.x * mapSize.y * mapSize.z)) return;
  ivec3 texel = ivec3(int(index) % mapSize.x, int(index) / mapSize.x % mapSize.y, int(index) / (mapSize.x * mapSize.y));
  uint code = texelFetch(nodes, texel, 0).r;
  if (code == 0u) return;
  uint brick = brickOfCode(code >> 3);
  if (brick == kNone) return;
  uint own = code & 7u, place = 8u * (brick - octreeLevels[octreeDepth].firstBrick) + own;
  ivec3 corner = texelOf(brick) + 2 * ivec3(own & 1u, own >> 1 & 1u, own >> 2);
  vec3 normal = 2.0 * texelFetch(normals, corner, 0).xyz - 1.0, toLight;
  vec3 arriving = arrivingIrradiance(lights[int(texelFetch(photonFlux, texel, 0).w)], texelFetch(photonPosition, texel, 0).xyz, toLight);
  vec3 radiance = texelFetch(colours, corner, 0).rgb * arriving / kPi * max(dot(normal, toLight) / max(length(normal), 1e-6), 0.0);
#if STAGE == STAGE_COUNT
  atomicAdd(sums[place].photons, 1u);
  atomicMax(sums[place].brightest, floatBitsToUint(max(radiance.r, max(radiance.g, radiance.b))));
#else
  float brightest = uintBitsToFloat(sums[place].brightest);
  uvec4 addend = shareOf(vec4(brightest > 0.0 ? min(radiance / brightest, 1.0) : vec3(0.0), 1.0) / float(sums[place].photons));
  atomicAdd(sums[place].red, addend.r);
  atomicAdd(sums[place].green, addend.g);
  atomicAdd(sums[place].blue, addend.b);
#endif
}
