// Real spherical harmonics of the bands 0 and 1, orthonormal, without the Condon-Shortley phase:
//   (Y00, Y1-1, Y10, Y11)(w) = (kY0, kY1 y, kY1 z, kY1 x).
#ifndef LUMIVOX_SPHERICAL_HARMONICS
#define LUMIVOX_SPHERICAL_HARMONICS
#include "common/constants.glsl"

const float kY0 = 0.28209479177387814;  // 1 / (2 sqrt pi)
const float kY1 = 0.48860251190291992;  // sqrt(3 / (4 pi))

// Basis functions in a direction of unit length.
vec4 shBasis(vec3 direction) { return vec4(kY0, kY1 * direction.yzx); }

// The projection of max(0, normal . w): its dot product with the coefficients of a radiance is the irradiance (Ramamoorthi & Hanrahan
// 2001, "An efficient representation for irradiance environment maps", Eq. 8: pi Y00 and 2 pi / 3 Y1m).
vec4 shClampedCosine(vec3 normal) { return vec4(kPi * kY0, (2.0 / 3.0) * kPi * kY1 * normal.yzx); }

#endif
