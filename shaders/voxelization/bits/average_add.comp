#version 450
// Each fragment adds its share of the averages over its voxel (common/integer_mean.glsl). Emission has a range per voxel.
#pragma lumivox axis ATTRIBUTES 0 1
#pragma lumivox axis EMISSION 0 1
#pragma lumivox require !EMISSION || ATTRIBUTES
#define AVERAGING
#include "average.glsl"
#include "toolkit/slot_of_voxel.glsl"

layout(std430, binding = 5) buffer CoverageSums { uint coverageSums[]; };
#if ATTRIBUTES
layout(std430, binding = 6) buffer AlbedoSums { uint albedoSums[]; };
layout(std430, binding = 7) buffer NormalSums { int normalSums[]; };
#endif
#if EMISSION
layout(std430, binding = 8) buffer EmissionSums { uint emissionSums[]; };
layout(std430, binding = 9) readonly buffer Brightest { uint brightest[]; };
#endif

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  uint slot;
  if (!slotOf(unpackVoxel(fragment.voxel), slot)) return;
  vec2 blueCoverage = unpackHalf2x16(fragment.albedoBCoverage);
  float covered = clamp(blueCoverage.y, 0.0, 1.0), weight = covered / float(fragmentsOfSlot[slot]);
  uint full = fullShare(fragmentsOfSlot[slot]);
  atomicAdd(coverageSums[slot], covered < 1.0 ? shareOf(weight) : full);
#if ATTRIBUTES
  vec3 albedo = clamp(vec3(unpackHalf2x16(fragment.albedoRg), blueCoverage.x), 0.0, 1.0);
  vec3 normal = unpackNormal(fragment.normal);
  for (int c = 0; c < 3; ++c) {
    atomicAdd(albedoSums[3u * slot + uint(c)], shareOf(albedo[c] * weight));
    atomicAdd(normalSums[3u * slot + uint(c)], signedShareOf(normal[c] * weight));
  }
#endif
#if EMISSION
  float range = uintBitsToFloat(brightest[slot]);
  vec3 emission = range > 0.0 ? min(emissionOf(fragment) / range, 1.0) : vec3(0.0);
  for (int c = 0; c < 3; ++c) atomicAdd(emissionSums[3u * slot + uint(c)], shareOf(emission[c] * weight));
#endif
}
