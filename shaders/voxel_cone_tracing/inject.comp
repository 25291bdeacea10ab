#version 450
// Crassin et al. 2011, Sec. 6; thesis 004 Sec. 4.2.1, Listing 4.8: light that each fragment reflects diffusely; and of each voxel how many
// fragments it has and how bright the brightest of them is, which add.comp needs for their average.
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis SHADOWS 0 1
#pragma lumivox axis REFLECTED 0 1
#pragma lumivox axis MEDIUM none even varying
#pragma lumivox require !SHADOWS || LIGHTS
#pragma lumivox require MEDIUM == none || LIGHTS
#include "common/constants.glsl"
#include "bricks.glsl"
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
#include "common/fragments.glsl"

layout(std140, binding = 0) uniform Grid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  int lightCount;
  float mostRadiance;   // W/(sr m^2): what no voxel of this size can reflect, however near a light is
  int twoSided;         // 1: light on the back side counts as well
  int mediumSteps;      // most steps through a medium that varies, towards a light
  ivec3 brickCount;
  float ambient;        // irradiance of all surfaces besides that of the lights, W/m^2
};
layout(std430, binding = 2) writeonly buffer Radiances { float radiances[]; };  // three of each fragment, W/(sr m^2)
layout(std430, binding = 3) readonly buffer Bricks { Brick bricks[]; };
layout(std430, binding = 4) buffer Sums { VoxelSums sums[]; };
#if REFLECTED
// Direct light that fragments are known to reflect: a word for each of the first of them.
layout(std430, binding = 7) readonly buffer Reflected { uint reflected[]; };
#endif

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  vec2 blueCoverage = unpackHalf2x16(fragment.albedoBCoverage);
  vec3 albedo = vec3(unpackHalf2x16(fragment.albedoRg), blueCoverage.x);
  vec3 irradiance = vec3(ambient);  // thesis Fig. 66
  int toAsk = lightCount;
#if REFLECTED
  uint known = index < uint(reflected.length()) ? reflected[index] : kNotKnown;
  if (known != kNotKnown) toAsk = 0;
#endif
#if LIGHTS
  vec3 posWorld = gridLow + (vec3(voxel) + unpackOffset(fragment.offset)) * voxelSize;
  vec3 normal = unpackNormal(fragment.normal);
  for (int i = 0; i < toAsk; ++i) {
    LightSample light = lights[i];
    vec3 toLight;
    vec3 perpendicular = arrivingIrradiance(light, posWorld, toLight);
    float cosSurface = dot(normal, toLight);
    if (twoSided != 0) cosSurface = abs(cosSurface);
    if (!(cosSurface > 0.0)) continue;  // also where a light lies on the surface and has no direction
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
  vec3 radiance = min(albedo / kPi * irradiance, mostRadiance);
#if REFLECTED
  if (known != kNotKnown) radiance = min(radiance + unpackShared(known), mostRadiance);  // with what the ambient term adds
#endif
  for (int channel = 0; channel < 3; ++channel) radiances[3 * index + channel] = radiance[channel];
  uint place = sumsOf(bricks[brickOf(voxel, brickCount)], bitOf(voxel));
  atomicAdd(sums[place].fragments, 1u);
  atomicMax(sums[place].brightest, floatBitsToUint(max(radiance.r, max(radiance.g, radiance.b))));
}
