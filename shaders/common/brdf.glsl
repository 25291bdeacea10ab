// The one surface model: Lambert diffuse / pi plus Phong specular (n + 2) / (2 pi) max(0, cos a)^n, a measured from the mirror
// direction. The path tracer uses the same formulas (laboratory/src/reference).
#ifndef LUMIVOX_BRDF
#define LUMIVOX_BRDF
#include "common/constants.glsl"

// Value of the Phong lobe, 1/sr. toEye and toLight are unit vectors away from the surface.
vec3 phongLobe(vec3 specular, float exponent, vec3 normal, vec3 toEye, vec3 toLight) {
  float cosMirror = max(0.0, dot(reflect(-toEye, normal), toLight));
  // 0^0 is undefined in GLSL: an exponent of 0 is a constant lobe over the half space around the mirror direction.
  float lobe = exponent > 0.0 ? pow(cosMirror, exponent) : (cosMirror > 0.0 ? 1.0 : 0.0);
  return specular * ((exponent + 2.0) / (2.0 * kPi) * lobe);
}

#endif
