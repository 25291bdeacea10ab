// The averaged light as the surface takes it: Lensing & Broll 2013, Eq. 10. Deviates: no squared distance, which
// the print has in Eq. 10 and 11. At the points it cancels; between them a place of mean light is no place of light.
#ifndef LUMIVOX_AVERAGED_LIGHT
#define LUMIVOX_AVERAGED_LIGHT

struct AveragedLight {
  vec4 light;  // rgb; w: of a glossy one 1 + exponent
  vec3 place;
};

// Cosine at a surface of a light at `place`, 0 behind the surface and at it.
float cosineTo(vec3 place, vec3 position, vec3 normal) {
  vec3 path = place - position;
  float distanceSquared = dot(path, path);
  return distanceSquared > 0.0 ? max(0.0, dot(path, normal) * inversesqrt(distanceSquared)) : 0.0;
}

// Eq. 10 and 11 as printed, as far as a float holds them: light over what it is divided by.
vec3 dividedAsPublished(vec3 light, float divisor) { return min(light / max(divisor, 1e-30), vec3(1e30)); }

// An exponent by which points as far apart as `spacing` still catch a light at that distance, `beta` of them in its lobe's width.
float resolvedExponent(float exponent, float distanceSquared, float spacing, float beta) {
  if (beta <= 0.0 || spacing <= 0.0) return exponent;
  return min(exponent, beta * distanceSquared / (spacing * spacing));
}

// cos^k of Eq. 10 for the glossy lobe; 0^0 is 1 in front of the mirror's plane.
float lobeCosine(float exponent, float cosMirror) {
  return cosMirror > 0.0 ? (exponent > 0.0 ? pow(cosMirror, exponent) : 1.0) : 0.0;
}

#endif
