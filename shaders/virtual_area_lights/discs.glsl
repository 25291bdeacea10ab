// A disc that shines, seen from a point of a surface: Lensing & Broll 2013, Eq. 3 to 5.
#ifndef LUMIVOX_DISCS
#define LUMIVOX_DISCS
#include "common/constants.glsl"
#include "common/rsm.glsl"

// w of Eq. 3: the form factor of a disc without the cosine at the receiver, sin^2 of its half angle where it faces the point.
// `cosAtDisc` may be negative: what is behind it sees nothing.
float discWidth(float area, float cosAtDisc, float distanceSquared) {
  return area * max(0.0, cosAtDisc) / (kPi * distanceSquared + area);
}

// Share of the normalised Phong lobe that a disc of width w covers whose middle is off the mirror direction by an angle of cosine cosMirror.
// In place of Eq. 5, which holds at the middle of the disc and so is beyond all bounds where the disc is wider than the lobe. In the
// middle of the lobe it is 1 - cos^(k + 2) of the disc's half angle, exact; a small disc gives (k + 2) / 2 w cos^k; at the edge of a wide
// disc it falls by half over the width of the lobe. In between it falls as A / (1 - B + B / cos^q): B, the place of the edge, is fitted to
// the integral over the disc (within 0.07), and q follows from it, so that over all directions it sums to the disc's own area, pi w.
float lobeShare(float exponent, float width, float cosMirror) {
  if (width <= 0.0 || cosMirror <= 0.0) return 0.0;
  float w = min(width, 1.0 - 1e-6);
  // -ln(1 - w), whose difference to 1 is lost where w is small.
  float bend = w < 1e-3 ? w * (1.0 + w * (0.5 + w / 3.0)) : -log(1.0 - w);
  float middle = 0.5 * (exponent + 2.0) * bend;
  middle = middle < 1e-2 ? middle * (1.0 - middle * (0.5 - middle / 6.0)) : 1.0 - exp(-middle);
  float spread = bend * exponent;  // of the disc over that of the lobe, squared
  float edge = spread / (3.0 + sqrt(spread));  // -ln B
  float steepness = 2.0 * middle / bend * (edge < 1e-2 ? 1.0 + 0.5 * edge : edge / (1.0 - exp(-edge))) * exponent / (exponent + 2.0);
  // Beyond 80 the exponential leaves nothing, and farther on it is beyond what a float holds.
  float beyond = -edge - steepness * log(cosMirror);
  return beyond > 80.0 ? 0.0 : middle / (1.0 - exp(-edge) + exp(beyond));
}

// What the Phong lobe of albedo 1 reflects of a disc of radiance 1: its share, times the cosine at the receiver. The cosine is that of the
// direction in which disc and lobe overlap, between the middles of both: at the middle of a wide disc it can be far from that of the lobe.
float lobeReflected(float exponent, float width, vec3 normal, vec3 toEye, vec3 toLight) {
  vec3 mirror = reflect(-toEye, normal);
  float share = dot(normal, toLight) > 0.0 ? lobeShare(exponent, width, dot(mirror, toLight)) : 0.0;
  if (share <= 0.0) return 0.0;
  float wide = width * (exponent + 2.0);
  vec3 between = mix(toLight, mirror, wide / (wide + 4.0));  // by the variances of disc and lobe, w / 4 and 1 / (k + 2)
  return share * max(0.0, dot(normal, normalize(between)));
}

// Eq. 5 as printed, without the albedo: per watt, no cosine at the receiver, `factor` left to the user.
float lobeReflectedAsPublished(float exponent, float width, float cosMirror, float factor) {
  float lobe = cosMirror > 0.0 ? (exponent > 0.0 ? pow(cosMirror, exponent) : 1.0) : 0.0;
  return factor * (exponent + 1.0) * width * lobe;
}

#endif
