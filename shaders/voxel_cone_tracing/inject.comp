#version 450
// Crassin et al. 2011, Sec. 6; thesis 004 Sec. 4.2.1, Listing 4.8: light that each fragment reflects diffusely, averaged per voxel.
// Deviates from Listing 4.9: its running average in 8 bits depends on the order of the writes and overflows past 255 fragments. Here each
// fragment adds its share of the average as an integer, and integer sums do not depend on the order:
//   sum over fragments of round(value / range * 2^31 / n),  0 <= value <= range,  so that the sum fits into 32 bits for any n.
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis SHADOWS 0 1
#pragma lumivox axis MEDIUM none even varying
#pragma lumivox require !SHADOWS || LIGHTS
#pragma lumivox require MEDIUM == none || LIGHTS
#include "common/constants.glsl"
#include "common/voxel.glsl"
#if SHADOWS
#define SHADOW_VIEWS
#endif
#if LIGHTS
#include "common/lights.glsl"
#endif
#if MEDIUM != MEDIUM_NONE
#include "common/media.glsl"
#endif

layout(local_size_x = 64) in;

layout(std140, binding = 0) uniform Grid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  int lightCount;
  float radianceRange;  // W/(sr m^2): the largest radiance that can be stored
  int twoSided;         // 1: light on the back side counts as well
  int mediumSteps;      // most steps through a medium that varies, towards a light
};
layout(std430, binding = 0) readonly buffer FragmentCount { uint fragmentCount; };
layout(std430, binding = 1) readonly buffer Fragments { VoxelFragment fragments[]; };
layout(binding = 0, r32ui) uniform readonly uimage3D counts;
// Volumes and not buffers: drivers limit how much of a buffer a shader can address.
layout(binding = 1, r32ui) uniform uimage3D sumRed;
layout(binding = 2, r32ui) uniform uimage3D sumGreen;
layout(binding = 3, r32ui) uniform uimage3D sumBlue;
layout(binding = 4, r32ui) uniform uimage3D sumCoverage;

void main() {
  uint index = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  vec2 blueCoverage = unpackHalf2x16(fragment.albedoBCoverage);
  vec3 albedo = vec3(unpackHalf2x16(fragment.albedoRg), blueCoverage.x);
  float coverage = clamp(blueCoverage.y, 0.0, 1.0);

  vec3 irradiance = vec3(0.0);
#if LIGHTS
  vec3 posWorld = gridLow + (vec3(voxel) + unpackOffset(fragment.offset)) * voxelSize;
  vec3 normal = unpackNormal(fragment.normal);
  for (int i = 0; i < lightCount; ++i) {
    LightSample light = lights[i];
    vec3 toLight;
    vec3 perpendicular = arrivingIrradiance(light, posWorld, toLight);
    float cosSurface = dot(normal, toLight);
    if (twoSided != 0) cosSurface = abs(cosSurface);
    if (cosSurface <= 0.0) continue;
    vec3 arriving = perpendicular * cosSurface;
#if SHADOWS
    arriving *= visibility(light, posWorld, dot(normal, toLight) < 0.0 ? -normal : normal, toLight);
#endif
#if MEDIUM != MEDIUM_NONE
    if (any(greaterThan(arriving, vec3(0.0)))) arriving *= transmittanceToLight(light, posWorld, mediumSteps);
#endif
    irradiance += arriving;
  }
#endif
  vec3 radiance = min(albedo / kPi * irradiance, radianceRange);
  float share = kFixedPoint / float(max(imageLoad(counts, voxel).r, 1u));
  uvec4 addend = uvec4(vec4(radiance / radianceRange, 1.0) * (coverage * share) + 0.5);
  if (addend.r != 0u) imageAtomicAdd(sumRed, voxel, addend.r);
  if (addend.g != 0u) imageAtomicAdd(sumGreen, voxel, addend.g);
  if (addend.b != 0u) imageAtomicAdd(sumBlue, voxel, addend.b);
  imageAtomicAdd(sumCoverage, voxel, addend.a);
}
