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

// Share of the light from a direction with this cosine to the normal that a Phong lobe of albedo 1 reflects, over all directions. The signed
// integral of the lobe times the cosine of the reflected direction is the cosine itself, whatever the exponent n; the part below the surface
// does not exist, so the share is larger by that part. At grazing incidence it is g = Gamma((n + 1) / 2) / (2 sqrt(pi) Gamma(n / 2 + 1)),
// where the ratio of the Gammas is 1 / sqrt(n / 2 + 1/4 + small); from there it falls with the slope -1/2 of every symmetric lobe to 0 at
// normal incidence. For n = 0 that is (1 + cosine) / 2, which is exact; elsewhere it is within 0.004 (test).
float phongAlbedo(float exponent, float cosine) {
  float halved = 0.5 * max(exponent, 0.0);
  float grazing = 0.5 / sqrt(kPi * (halved + 0.25 + 0.0683 / (1.0 + 1.86 * halved)));
  return cosine + grazing * pow(1.0 - min(cosine, 1.0), 0.5 / grazing);
}

// The same share of light that arrives evenly from all sides: twice the integral of phongAlbedo times the cosine.
float phongAlbedo(float exponent) {
  float grazing = phongAlbedo(exponent, 0.0), power = 0.5 / grazing;
  return 2.0 / 3.0 + 2.0 * grazing / ((power + 1.0) * (power + 2.0));
}

#endif
