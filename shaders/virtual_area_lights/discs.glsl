// An emitting disc seen from a point of a surface: Lensing & Broll 2013, Eq. 3 to 5.
#ifndef LUMIVOX_DISCS
#define LUMIVOX_DISCS
#include "common/constants.glsl"
#include "common/rsm.glsl"

// w of Eq. 3: the form factor of a disc without the cosine at the receiver; for a disc that faces the point, sin^2 of its half angle.
// `cosAtDisc` may be negative: the result is 0 behind the disc.
float discWidth(float area, float cosAtDisc, float distanceSquared) {
  return area * max(0.0, cosAtDisc) / (kPi * distanceSquared + area);
}

// Share of the normalised Phong lobe that a disc of width w covers, if the angle between its centre and the mirror direction has the cosine
// cosMirror. Replaces Eq. 5, which evaluates the lobe at the disc's centre and is unbounded if the disc is wider than the lobe. For a disc
// in the middle of the lobe the share is 1 - cos^(k + 2) of the disc's half angle, exactly. A small disc gives (k + 2) / 2 w cos^k. At the
// edge of a wide disc the share falls by half over the width of the lobe. In between it falls as A / (1 - B + B / cos^q). B, the position
// of the edge, is fitted to the integral over the disc (within 0.07); q follows from B, so that the integral over all directions is the
// disc's area, pi w.
float lobeShare(float exponent, float width, float cosMirror) {
  if (width <= 0.0 || cosMirror <= 0.0) return 0.0;
  float w = min(width, 1.0 - 1e-6);
  // -ln(1 - w), by a series for small w, where 1 - w loses precision.
  float bend = w < 1e-3 ? w * (1.0 + w * (0.5 + w / 3.0)) : -log(1.0 - w);
  float middle = 0.5 * (exponent + 2.0) * bend;
  middle = middle < 1e-2 ? middle * (1.0 - middle * (0.5 - middle / 6.0)) : 1.0 - exp(-middle);
  float spread = bend * exponent;  // squared width of the disc over that of the lobe
  float edge = spread / (3.0 + sqrt(spread));  // -ln B
  float steepness = 2.0 * middle / bend * (edge < 1e-2 ? 1.0 + 0.5 * edge : edge / (1.0 - exp(-edge))) * exponent / (exponent + 2.0);
  // Beyond 80 the share is negligible, and the exponential would soon overflow a float.
  float beyond = -edge - steepness * log(cosMirror);
  return beyond > 80.0 ? 0.0 : middle / (1.0 - exp(-edge) + exp(beyond));
}

// Radiance that a Phong lobe of albedo 1 reflects of a disc of radiance 1: its share times the cosine at the receiver. The cosine is taken
// in the direction where disc and lobe overlap, between their centres: the centre of a wide disc can be far from the lobe.
float lobeReflected(float exponent, float width, vec3 normal, vec3 toEye, vec3 toLight) {
  vec3 mirror = reflect(-toEye, normal);
  float share = dot(normal, toLight) > 0.0 ? lobeShare(exponent, width, dot(mirror, toLight)) : 0.0;
  if (share <= 0.0) return 0.0;
  float wide = width * (exponent + 2.0);
  vec3 between = mix(toLight, mirror, wide / (wide + 4.0));  // by the variances of disc and lobe, w / 4 and 1 / (k + 2)
  return share * max(0.0, dot(normal, normalize(between)));
}

// Eq. 5 as printed, without the albedo: per watt, without the cosine at the receiver; `factor` is the free factor c.
float lobeReflectedAsPublished(float exponent, float width, float cosMirror, float factor) {
  float lobe = cosMirror > 0.0 ? (exponent > 0.0 ? pow(cosMirror, exponent) : 1.0) : 0.0;
  return factor * (exponent + 1.0) * width * lobe;
}

#endif
