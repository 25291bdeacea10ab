// Scattering by a medium. C++ side: laboratory/src/reference/media.cpp.
#ifndef LUMIVOX_PHASE
#define LUMIVOX_PHASE
#include "common/constants.glsl"

// Henyey & Greenstein 1941, "Diffuse radiation in the galaxy", Eq. 2: density per sr of scattering by an angle with this cosine, whose
// mean is g. Deviates from thesis 004 Eq. 1: (1-g^2) in place of (1-g)^2, so that it integrates to 1 over the sphere.
// toLight and view are unit vectors: the direction to the light, and the direction of a ray from the eye.
float phase(float g, vec3 toLight, vec3 view) {
  // 1 + g^2 - 2 g cos = (1 - |g|)^2 + 2 |g| (1 -+ cos), where 1 -+ cos is half the squared difference (or sum) of the vectors: no
  // cancellation for light that is hardly deflected.
  vec3 apart = g >= 0.0 ? toLight - view : toLight + view;
  float denominator = (1.0 - abs(g)) * (1.0 - abs(g)) + abs(g) * dot(apart, apart);
  return (1.0 - g) * (1.0 + g) / (4.0 * kPi * denominator * sqrt(denominator));
}

// As thesis 004 Eq. 1 prints it. Integrates to (1-g) / (1+g).
float phaseAsPublished(float g, vec3 toLight, vec3 view) { return phase(g, toLight, view) * (1.0 - g) / (1.0 + g); }

#endif
