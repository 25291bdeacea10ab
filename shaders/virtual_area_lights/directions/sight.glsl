// The directions of a point: a grid over the square that the concentric map (Shirley & Chiu 1997) takes to the unit disc, whose points are
// directions projected along the normal. All cells have the same form factor, 1 / (kSightSide * kSightSide). C++ side: PointSight in
// techniques/virtual_area_lights/directions/point_sight.h.
#ifndef LUMIVOX_SIGHT
#define LUMIVOX_SIGHT
#include "common/constants.glsl"

const int kSightSide = 8;
const uint kSeesNothing = 0xffffffffu;

// Axes of the plane of a surface.
void planeAxes(vec3 normal, out vec3 tangent, out vec3 binormal) {
  vec3 helper = abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
  tangent = normalize(cross(helper, normal));
  binormal = cross(normal, tangent);
}

// Place in 0..1 squared of a place in the unit disc.
vec2 squareFromDisc(vec2 disc) {
  vec2 away = abs(disc);
  float radius = length(disc);
  if (radius == 0.0) return vec2(0.5);
  float other = 4.0 / kPi * atan(min(away.x, away.y), max(away.x, away.y)) * radius;
  vec2 place = away.x >= away.y ? vec2(radius, other) : vec2(other, radius);
  return 0.5 + 0.5 * place * vec2(disc.x < 0.0 ? -1.0 : 1.0, disc.y < 0.0 ? -1.0 : 1.0);
}

// Place in the unit disc of a place in 0..1 squared.
vec2 discFromSquare(vec2 square) {
  vec2 place = 2.0 * square - 1.0;
  if (place == vec2(0.0)) return vec2(0.0);
  if (abs(place.x) > abs(place.y)) {
    float angle = 0.25 * kPi * place.y / place.x;
    return place.x * vec2(cos(angle), sin(angle));
  }
  float angle = 0.25 * kPi * place.x / place.y;
  return place.y * vec2(sin(angle), cos(angle));
}

// The middle of a cell, a unit vector along tangent, binormal and normal.
vec3 sightDirection(ivec2 cell) {
  vec2 disc = discFromSquare((vec2(cell) + 0.5) / float(kSightSide));
  return vec3(disc, sqrt(max(0.0, 1.0 - dot(disc, disc))));
}

// A disc's point and its distance, so that the smaller entry is the nearer one.
uint sightEntry(float distance, uint point) { return (floatBitsToUint(distance) & 0xffff0000u) | point; }
float sightDistance(uint entry) { return uintBitsToFloat(entry & 0xffff0000u); }
uint sightPoint(uint entry) { return entry & 0xffffu; }

#endif
