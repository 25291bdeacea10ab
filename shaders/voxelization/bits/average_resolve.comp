#version 450
// Turns sums into averages: opacity by the rule of the list, attributes weighted by coverage.
#pragma lumivox axis ATTRIBUTES 0 1
#pragma lumivox axis EMISSION 0 1
#pragma lumivox axis OPACITY 0 1
#pragma lumivox require !EMISSION || ATTRIBUTES
#define AVERAGING
#include "average.glsl"
#include "toolkit/slots.glsl"

layout(std430, binding = 5) readonly buffer CoverageSums { uint coverageSums[]; };
#if ATTRIBUTES
layout(std430, binding = 6) readonly buffer AlbedoSums { uint albedoSums[]; };
layout(std430, binding = 7) readonly buffer NormalSums { int normalSums[]; };
layout(binding = 0, rgba16f) uniform writeonly image3D albedoImage;
layout(binding = 1, rgba16f) uniform writeonly image3D normalImage;
#endif
#if EMISSION
layout(std430, binding = 8) readonly buffer EmissionSums { uint emissionSums[]; };
layout(std430, binding = 9) readonly buffer Brightest { uint brightest[]; };
layout(binding = 2, rgba32f) uniform writeonly image3D emissionImage;
#endif
#if OPACITY
layout(binding = 3, r8) uniform writeonly image3D opacityImage;
#endif

void main() {
  uint slot;
  ivec3 voxel;
  if (!slotHere(slot, voxel)) return;
  // Relative to the sum of full coverages, which has the same rounding: a voxel whose fragments all have coverage 1 is exactly opaque.
  uint fragments = fragmentsOfSlot[slot];
  float mean = float(coverageSums[slot]) / float(fragments * fullShare(fragments));
  float opacity = min(coverageSum != 0 ? mean * float(fragments) : mean, 1.0);
#if OPACITY
  imageStore(opacityImage, voxel, vec4(opacity));
#endif
#if ATTRIBUTES
  // If all coverages are 0 there is no average.
  float inverse = mean > 0.0 ? kFixedPoint / float(coverageSums[slot]) : 0.0;
  vec3 albedo = meanOf(albedoSums[3u * slot], albedoSums[3u * slot + 1u], albedoSums[3u * slot + 2u]);
  vec3 normal = signedMeanOf(normalSums[3u * slot], normalSums[3u * slot + 1u], normalSums[3u * slot + 2u]);
  imageStore(albedoImage, voxel, vec4(albedo * inverse, opacity));
  imageStore(normalImage, voxel, vec4(normal * inverse, 0.0));
#endif
#if EMISSION
  vec3 emission = meanOf(emissionSums[3u * slot], emissionSums[3u * slot + 1u], emissionSums[3u * slot + 2u]);
  imageStore(emissionImage, voxel, vec4(emission * inverse * uintBitsToFloat(brightest[slot]), opacity));
#endif
}
