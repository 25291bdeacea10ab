// Direct light of the visible surfaces, from a g-buffer: emission, and every light sample times its visibility, reflected by both lobes.
// The includer has the axes LIGHTS, GLOSSY, EMISSION and MEDIUM. With LIGHTS it defines visibleShare, the visible fraction of light sample
// i, in [0,1]: posWorld is on the surface, geometricNormal faces the lit side, and toLight has unit length.
#ifndef LUMIVOX_DIRECT_LIGHT
#define LUMIVOX_DIRECT_LIGHT
// An including file first declares vec3 environmentSeen(vec3 constant, ivec2 pixel): what a camera ray sees that meets no surface.
#include "common/brdf.glsl"
#if LIGHTS
#include "common/lights.glsl"
float visibleShare(int i, LightSample light, vec3 posWorld, vec3 geometricNormal, vec3 toLight);
#endif
#if MEDIUM != MEDIUM_NONE
#include "common/media.glsl"
#endif

layout(std140, binding = 0) uniform DirectLight {
  vec3 eyeWorld;
  int lightCount;
  vec3 environment;  // radiance that a camera ray sees when it hits nothing
  int mediumSteps;   // step limit through a heterogeneous medium, towards a light
};

layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
layout(binding = 3) uniform sampler2D gDiffuse;
#if GLOSSY
layout(binding = 5) uniform sampler2D gSpecular;
#endif
#if EMISSION
// An image, because voxel stores may need all remaining samplers; it is read once and unfiltered.
layout(binding = 1, rgba32f) uniform readonly image2D emissionImage;
#endif

#if LIGHTS
vec3 reflectedLight(ivec2 pixel, vec3 posWorld) {
  vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
  vec3 geometricNormal = texelFetch(gGeometricNormal, pixel, 0).xyz;
  vec3 diffuse = texelFetch(gDiffuse, pixel, 0).rgb;
  vec3 toEye = normalize(eyeWorld - posWorld);
  vec3 reflected = vec3(0.0);
  for (int i = 0; i < lightCount; ++i) {
    LightSample light = lights[i];
    vec3 toLight;
    vec3 perpendicular = arrivingIrradiance(light, posWorld, toLight);
    float cosSurface = dot(normal, toLight);
    // Light from below the shading plane or the geometric plane does not reach the visible side.
    if (cosSurface <= 0.0 || dot(geometricNormal, toLight) <= 0.0) continue;
    vec3 irradiance = perpendicular * cosSurface;
    // Visibility may be expensive: it is evaluated only for lights that emit in this direction.
    if (all(lessThanEqual(irradiance, vec3(0.0)))) continue;
    irradiance *= visibleShare(i, light, posWorld, geometricNormal, toLight);
#if MEDIUM != MEDIUM_NONE
    if (any(greaterThan(irradiance, vec3(0.0)))) irradiance *= transmittanceToLight(light, posWorld, mediumSteps);
#endif
    vec3 lobes = diffuse / kPi;
#if GLOSSY
    vec4 specular = texelFetch(gSpecular, pixel, 0);
    lobes += phongLobe(specular.rgb, specular.w, normal, toEye, toLight);
#endif
    reflected += irradiance * lobes;
  }
  return reflected;
}
#endif

// Radiance towards the eye, W/(sr m^2).
vec3 directLight(ivec2 pixel) {
  vec4 position = texelFetch(gPosition, pixel, 0);
  if (position.w == 0.0) return environmentSeen(environment, pixel);
  vec3 radiance = vec3(0.0);
#if EMISSION
  radiance += imageLoad(emissionImage, pixel).rgb;
#endif
#if LIGHTS
  radiance += reflectedLight(pixel, position.xyz);
#endif
  return radiance;
}

#endif
