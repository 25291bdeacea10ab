// Direction bins on the faces of a cube, as techniques/implicit_visibility/links/direction_bins.h describes them. Their centres and solid
// angles are in the buffer `directions` of ElementLinks.

/// The bin of a direction of any length above 0.
uint directionBin(vec3 direction, int side, bool even) {
  vec3 size = abs(direction);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  float along = direction[axis];
  vec2 ratio = vec2(direction[(axis + 1) % 3], direction[(axis + 2) % 3]) / along;
  vec2 along01 = even ? atan(ratio) / 0.785398163 : ratio;
  ivec2 line = clamp(ivec2(floor(0.5 * (along01 + 1.0) * float(side))), ivec2(0), ivec2(side - 1));
  int face = 2 * axis + (along < 0.0 ? 1 : 0);
  return uint((face * side + line.y) * side + line.x);
}

/// The unit vector to the centre of a bin.
vec3 directionOfBin(uint bin, int side, bool even) {
  int perFace = side * side, face = int(bin) / perFace, within = int(bin) - face * perFace, axis = face / 2;
  vec2 ratio = (2.0 * vec2(within % side, within / side) + 1.0) / float(side) - 1.0;
  if (even) ratio = tan(0.785398163 * ratio);
  vec3 direction = vec3(0.0);
  direction[axis] = 1.0;
  direction[(axis + 1) % 3] = ratio.x;
  direction[(axis + 2) % 3] = ratio.y;
  return normalize(direction) * ((face & 1) == 0 ? 1.0 : -1.0);
}
