// The light that arrives at both sides of a surface. Included after common/lights.glsl, with SHADOW_VIEWS for shadows, and, with an axis
// MEDIUM, after common/media.glsl.
#ifndef LUMIVOX_TWO_SIDED_LIGHT
#define LUMIVOX_TWO_SIDED_LIGHT

// Irradiance at a point due to one light, W/m^2, 0 on the back unless twoSided; `behind`: it arrives on the back. `cosSurface`: of the
// light's direction to the normal of that side. mediumSteps: largest number of steps through a heterogeneous medium towards a light.
vec3 irradianceFrom(LightSample light, vec3 posWorld, vec3 normal, bool twoSided, int mediumSteps, out bool behind, out float cosSurface) {
  vec3 toLight;
  vec3 perpendicular = arrivingIrradiance(light, posWorld, toLight);
  cosSurface = dot(normal, toLight);
  behind = cosSurface < 0.0;
  if (behind && !twoSided) return vec3(0.0);
  cosSurface = abs(cosSurface);
  if (!(cosSurface > 0.0)) return vec3(0.0);  // also if the light lies at the point: there is no direction to it
  vec3 arriving = perpendicular * cosSurface;
#ifdef SHADOW_VIEWS
  arriving *= visibility(light, posWorld, behind ? -normal : normal, toLight);
#endif
#ifdef MEDIUM
#if MEDIUM != MEDIUM_NONE
  if (any(greaterThan(arriving, vec3(0.0)))) arriving *= transmittanceToLight(light, posWorld, mediumSteps);
#endif
#endif
  return arriving;
}

// Adds that irradiance to `front` on the side of the normal; to `back` behind it.
void addArrivingFrom(LightSample light, vec3 posWorld, vec3 normal, bool twoSided, int mediumSteps, inout vec3 front, inout vec3 back) {
  bool behind;
  float cosSurface;
  vec3 arriving = irradianceFrom(light, posWorld, normal, twoSided, mediumSteps, behind, cosSurface);
  if (behind) back += arriving;
  else front += arriving;
}

// addArrivingFrom for the first lightCount lights.
void addArriving(int lightCount, vec3 posWorld, vec3 normal, bool twoSided, int mediumSteps, inout vec3 front, inout vec3 back) {
  for (int i = 0; i < lightCount; ++i) addArrivingFrom(lights[i], posWorld, normal, twoSided, mediumSteps, front, back);
}

#endif
