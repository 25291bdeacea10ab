// Evenly spaced points on a square with the area of a leaf.
#ifndef LUMIVOX_LEAF_POINTS
#define LUMIVOX_LEAF_POINTS

struct LeafSquare {
  vec3 middle, along, across;
};

// `place`: xyz centre, w area, m^2.
LeafSquare squareOf(vec4 place, vec3 normal) {
  vec3 along = abs(normal.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
  along = cross(normal, along);
  if (place.w > 0.0) along *= sqrt(place.w) * inversesqrt(max(dot(along, along), 1e-12));
  return LeafSquare(place.xyz, along, cross(normal, along));
}

vec3 pointOf(LeafSquare square, int number, int perSide) {
  vec2 offset = (vec2(number % perSide, number / perSide) + 0.5) / float(perSide) - 0.5;
  return square.middle + offset.x * square.along + offset.y * square.across;
}
#endif
