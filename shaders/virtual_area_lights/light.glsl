// The averaged light as a surface reflects it: Lensing & Broll 2013, Eq. 10. Deviates: without the squared distance of the printed Eq. 10
// and 11. At the points it cancels; between points the interpolated position is not the position of a light.
#ifndef LUMIVOX_AVERAGED_LIGHT
#define LUMIVOX_AVERAGED_LIGHT

struct AveragedLight {
  vec4 light;  // rgb; w of a glossy light: 1 + exponent
  vec3 place;
};

// Cosine at a surface towards a light at `place`; 0 if the light lies behind the surface or at its position.
float cosineTo(vec3 place, vec3 position, vec3 normal) {
  vec3 path = place - position;
  float distanceSquared = dot(path, path);
  return distanceSquared > 0.0 ? max(0.0, dot(path, normal) * inversesqrt(distanceSquared)) : 0.0;
}

// Light divided by `divisor`, as Eq. 10 and 11 print it, limited to the range of a float.
vec3 dividedAsPublished(vec3 light, float divisor) { return min(light / max(divisor, 1e-30), vec3(1e30)); }

// The exponent, limited so that points `spacing` apart resolve a light at that distance: `beta` points fit into the width of the lobe.
float resolvedExponent(float exponent, float distanceSquared, float spacing, float beta) {
  if (beta <= 0.0 || spacing <= 0.0) return exponent;
  return min(exponent, beta * distanceSquared / (spacing * spacing));
}

// cos^k of Eq. 10 for the glossy lobe; 0^0 is 1 in front of the mirror's plane.
float lobeCosine(float exponent, float cosMirror) {
  return cosMirror > 0.0 ? (exponent > 0.0 ? pow(cosMirror, exponent) : 1.0) : 0.0;
}

#endif
