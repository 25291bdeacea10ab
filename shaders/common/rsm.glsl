// Texels of a reflective shadow map as small lights (Dachsbacher & Stamminger 2005). C++ side: port ReflectiveShadowMap.
#ifndef LUMIVOX_RSM
#define LUMIVOX_RSM
#include "common/constants.glsl"

// A patch of a surface that reflects light diffusely.
struct SurfaceLight {
  vec4 positionArea;  // xyz posWorld, w area of the patch, m^2
  vec4 normal;        // xyz unit, to the side that shines
  vec4 flux;          // rgb reflected flux, W
};

// Irradiance at a surface, W/m^2, without visibility (Dachsbacher & Stamminger 2005, Sec. 3.1, Eq. 1: a light of intensity
// flux / pi times the cosine). Deviates: the patch is a disc of its area, flux cos cos / (pi d^2 + area), which is exact on the axis of
// a disc (Lambert) and stays finite where the patch is near; as area goes to 0 it is the published inverse square law.
vec3 surfaceLightIrradiance(SurfaceLight light, vec3 posWorld, vec3 normal) {
  vec3 path = light.positionArea.xyz - posWorld;
  float distanceSquared = dot(path, path);
  if (distanceSquared == 0.0) return vec3(0.0);
  vec3 toLight = path * inversesqrt(distanceSquared);
  float cosines = max(0.0, dot(toLight, normal)) * max(0.0, -dot(toLight, light.normal.xyz));
  return light.flux.rgb * (cosines / (kPi * distanceSquared + light.positionArea.w));
}

// Weight by which texels are chosen.
float luminance(vec3 value) { return dot(value, vec3(0.2126, 0.7152, 0.0722)); }  // Rec. 709

#endif
