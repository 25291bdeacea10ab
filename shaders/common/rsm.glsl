// Texels of a reflective shadow map as small lights (Dachsbacher & Stamminger 2005). C++ side: port ReflectiveShadowMap.
#ifndef LUMIVOX_RSM
#define LUMIVOX_RSM
#include "common/constants.glsl"

// A patch of a surface that reflects light, diffusely unless it has a lobe.
struct SurfaceLight {
  vec4 positionArea;  // xyz posWorld, w area of the patch, m^2
  vec4 normal;        // xyz unit, on the reflecting side; w 0, or direction and width of a lobe (surface_lobe.glsl)
  vec4 flux;          // rgb reflected flux, W, of both lobes; w 0, or the flux that the lobe would reflect at normal incidence, packed
};

// Share of a disc's flux that arrives on each square metre of a surface at posWorld, 1/m^2, without visibility: the form factor of the disc
// over its area, cos cos / (pi d^2 + area). It is exact on the axis of the disc (Lambert) and stays finite near the disc.
float sharePerArea(SurfaceLight light, vec3 posWorld, vec3 normal) {
  vec3 path = light.positionArea.xyz - posWorld;
  float distanceSquared = dot(path, path);
  if (distanceSquared == 0.0) return 0.0;
  vec3 toLight = path * inversesqrt(distanceSquared);
  float cosines = max(0.0, dot(toLight, normal)) * max(0.0, -dot(toLight, light.normal.xyz));
  return cosines / (kPi * distanceSquared + light.positionArea.w);
}

// Irradiance at a surface, W/m^2, without visibility (Dachsbacher & Stamminger 2005, Sec. 3.1, Eq. 1: a light of intensity
// flux / pi times the cosine). Deviates: the patch is a disc of its area; as the area goes to 0, this is the published inverse square law.
vec3 surfaceLightIrradiance(SurfaceLight light, vec3 posWorld, vec3 normal) {
  return light.flux.rgb * sharePerArea(light, posWorld, normal);
}

// Weight by which texels are chosen.
float luminance(vec3 value) { return dot(value, vec3(0.2126, 0.7152, 0.0722)); }  // Rec. 709

#endif
