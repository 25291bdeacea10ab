// Sec. 3.3: lights and occluders as squares in the unit disc of a point's projected hemisphere (Fig. 3).
#ifndef LUMIVOX_SQUARES
#define LUMIVOX_SQUARES
#include "common/constants.glsl"

struct Square {
  vec2 centre;
  float side;
};

// Eq. 14: the projected direction is the centre of the square; its area is pi times the form factor (Nusselt).
Square squareOf(vec3 direction, float formFactor, vec3 tangent, vec3 binormal) {
  return Square(vec2(dot(direction, tangent), dot(direction, binormal)), sqrt(kPi * formFactor));
}

// Share of `light` that `occluder` covers.
float coveredShare(Square light, Square occluder) {
  vec2 reach = vec2(0.5 * (light.side + occluder.side)) - abs(light.centre - occluder.centre);
  vec2 overlap = clamp(reach, vec2(0.0), vec2(min(light.side, occluder.side)));
  return light.side > 0.0 ? overlap.x * overlap.y / (light.side * light.side) : 0.0;
}

// The bits of the 8 x 8 cells of `light`, row by row in two words, whose centres `occluder` covers.
uvec2 coveredBits(Square light, Square occluder) {
  vec2 low = occluder.centre - light.centre + 0.5 * (light.side - vec2(occluder.side));
  ivec2 first = ivec2(clamp(ceil(8.0 * low / light.side - 0.5), vec2(0.0), vec2(8.0)));
  ivec2 end = ivec2(clamp(ceil(8.0 * (low + occluder.side) / light.side - 0.5), vec2(0.0), vec2(8.0)));
  if (any(greaterThanEqual(first, end))) return uvec2(0u);
  uint row = ((1u << end.x) - (1u << first.x)) * 0x01010101u;
  // Rows below `count`, as bits: a shift by 32 is undefined.
  ivec2 lowRows = clamp(ivec2(first.y, end.y), 0, 4), highRows = clamp(ivec2(first.y, end.y) - 4, 0, 4);
  uvec2 before = uvec2(lowRows.x == 4 ? ~0u : (1u << (8 * lowRows.x)) - 1u, highRows.x == 4 ? ~0u : (1u << (8 * highRows.x)) - 1u);
  uvec2 until = uvec2(lowRows.y == 4 ? ~0u : (1u << (8 * lowRows.y)) - 1u, highRows.y == 4 ? ~0u : (1u << (8 * highRows.y)) - 1u);
  return row & until & ~before;
}

// Form factor of a sphere, without clipping at the horizon: cos r^2 / d^2, and 1 inside the sphere. Deviates: the print uses the form
// factor of a disc, which is too small by the factor 1 + r^2 / d^2 (`published`).
float sphereFormFactor(float cosine, float radiusSquared, float distanceSquared, bool published) {
  if (published) return max(0.0, cosine) * radiusSquared / (distanceSquared + radiusSquared);
  return distanceSquared <= radiusSquared ? 1.0 : max(0.0, cosine) * radiusSquared / distanceSquared;
}

#endif
