#version 450
// The radiance that the photons of a voxel reflect, by one of two rules:
// - kSum: their sum, so that no flux is lost where photons lie further apart than voxels (Crassin et al. 2011, Sec. 6). A surface with the
//   normal n meets |nx| + |ny| + |nz| voxels of width w per area w^2.
// - kAverage: for one light, their average weighted by the areas that they represent (thesis 004, Sec. 4.2.2, Listing 4.24). Deviates:
//   photons have their own reflected flux instead of the average reflectance of the voxel's surface.
// Neither depends on the order of the photons (common/integer_mean.glsl), unlike the listing.
#pragma lumivox axis STAGE count add
layout(local_size_x = 64) in;
#include "octree_photons.glsl"
#include "common/constants.glsl"
#include "common/integer_mean.glsl"

const int kSum = 0, kAverage = 1;
layout(constant_id = 0) const int rule = kSum;

layout(std140, binding = 0) uniform PhotonsOfLight {
  ivec3 mapSize;  // texels, layers
  int light;      // kAverage: the light whose photons count
  float voxelSize;  // m
};
layout(binding = 1) uniform sampler2DArray photonNormal;
layout(binding = 2) uniform sampler2DArray photonFlux;
layout(binding = 3) uniform usampler2DArray nodes;
layout(std430, binding = 4) buffer Sums { PhotonSums sums[]; };

void main() {
  uint index = listIndex();
  if (index >= uint(mapSize.x * mapSize.y * mapSize.z)) return;
  ivec3 texel = ivec3(int(index) % mapSize.x, int(index) / mapSize.x % mapSize.y, int(index) / (mapSize.x * mapSize.y));
  uint code = texelFetch(nodes, texel, 0).r;
  vec4 normalArea = texelFetch(photonNormal, texel, 0), flux = texelFetch(photonFlux, texel, 0);
  float area = normalArea.w;
  if (code == 0u || !(area > 0.0) || (rule == kAverage && int(flux.w) != light)) return;
  uint brick = brickOfCode(code >> 3);
  if (brick == kNone) return;
  uint place = 8u * (brick - octreeLevels[octreeDepth].firstBrick) + (code & 7u);
  // A Lambertian surface that reflects a flux from an area has the radiance flux / (pi area).
  vec3 steepness = abs(normalArea.xyz);
  float inVoxel = voxelSize * voxelSize / (steepness.x + steepness.y + steepness.z);
  vec3 radiance = max(flux.rgb, 0.0) / (kPi * (rule == kSum ? inVoxel : area));
#if STAGE == STAGE_COUNT
  atomicAdd(sums[place].photons, 1u);
  atomicMax(sums[place].brightest, floatBitsToUint(max(radiance.r, max(radiance.g, radiance.b))));
  atomicMax(sums[place].largestArea, floatBitsToUint(area));
#else
  float brightest = uintBitsToFloat(sums[place].brightest);
  float weight = (rule == kSum ? 1.0 : area / uintBitsToFloat(sums[place].largestArea)) / float(sums[place].photons);
  uvec4 addend = shareOf(vec4(brightest > 0.0 ? min(radiance / brightest, 1.0) : vec3(0.0), 1.0) * weight);
  atomicAdd(sums[place].red, addend.r);
  atomicAdd(sums[place].green, addend.g);
  atomicAdd(sums[place].blue, addend.b);
  atomicAdd(sums[place].weight, addend.a);
#endif
}
