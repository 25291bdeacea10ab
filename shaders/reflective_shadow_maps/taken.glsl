// Texels of the map as lights.
#ifndef LUMIVOX_TAKEN
#define LUMIVOX_TAKEN
#include "common/rsm.glsl"
#include "cross_section.glsl"
#if GLOSSY
#include "common/surface_lobe.glsl"
layout(binding = 3) uniform sampler2DArray rsmSpecular;
#endif

layout(binding = 0) uniform sampler2DArray rsmPosition;
layout(binding = 1) uniform sampler2DArray rsmNormal;
layout(binding = 2) uniform sampler2DArray rsmFlux;
layout(std430, binding = 1) writeonly buffer Taken { SurfaceLight taken[]; };

// Kinds of area of a light, in the order of the parameter `area` of choose.
const int kAreaSurface = 0;  // the area of the surface
const int kAreaShared = 1;   // the same, divided among the samples of an area light, which light the same surfaces
const int kAreaFacing = 2;   // the area of a texel that faces the light (Lensing and Broll 2013, Sec. 4.1)

// A texel as a light that represents `copies` equal texels.
SurfaceLight texelLight(ivec3 texel, float copies, int kindOfArea) {
  vec4 normalArea = texelFetch(rsmNormal, texel, 0), flux = texelFetch(rsmFlux, texel, 0);
  vec3 posWorld = texelFetch(rsmPosition, texel, 0).xyz;
  float area = normalArea.w;
  if (kindOfArea == kAreaShared) area *= partOfLight(lights[int(flux.w)]);
  if (kindOfArea == kAreaFacing && area > 0.0)
    area = crossSectionOf(lights[int(flux.w)], posWorld, vec2(texel.xy) + 0.5 - 0.5 * vec2(textureSize(rsmFlux, 0).xy));
  SurfaceLight result = SurfaceLight(vec4(posWorld, area * copies), vec4(normalArea.xyz, 0.0), vec4(flux.rgb * copies, 0.0));
#if GLOSSY
  vec4 specular = texelFetch(rsmSpecular, texel, 0);
  if (any(greaterThan(specular.rgb, vec3(0.0))) && normalArea.w > 0.0) {
    LightSample light = lights[int(flux.w)];
    vec3 toLight, perpendicular = arrivingIrradiance(light, posWorld, toLight);
    float crossSection = crossSectionOf(light, posWorld, vec2(texel.xy) + 0.5 - 0.5 * vec2(textureSize(rsmFlux, 0).xy));
    result.normal.w = packLobe(reflect(-toLight, normalArea.xyz), specular.w);
    result.flux.w = packFlux(specular.rgb * perpendicular * (crossSection * copies));
  }
#endif
  return result;
}

#endif
