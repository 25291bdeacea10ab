// The averaged light as the surface takes it: Lensing & Broll 2013, Eq. 10, which has no distance in it.
#ifndef LUMIVOX_AVERAGED_LIGHT
#define LUMIVOX_AVERAGED_LIGHT

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
