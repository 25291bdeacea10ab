// Blends the three faces of a voxel that face against a cone's direction: Crassin et al. 2011, Sec. 8.1; thesis 004, Listing 4.15.
#ifndef LUMIVOX_THROUGH_FACES
#define LUMIVOX_THROUGH_FACES

vec3 faceWeights(vec3 direction) {
  vec3 along = abs(direction);
  return along / (along.x + along.y + along.z);
}

// A step of `lengths` voxels through three faces of a level, across x, y and z; each face is read from the layer of voxels across its axis
// that contains the middle of the step. The transmittances are multiplied, with the printed weights as exponents. `at` and `apex` are the
// middle of the step and the apex of the cone, in voxels; `fromWall`: the level is the finest level at the cone's apex.
vec4 throughFaces(vec4 x, vec4 y, vec4 z, vec3 direction, vec3 at, vec3 apex, bool fromWall, float lengths) {
  vec3 weights = faceWeights(direction);
  // Near an edge of a room, a cone begins in the layer of the adjacent wall. The wall's position within the layer is unknown and assumed to
  // be the middle: a cone that leads away from the middle does not hit the wall.
  if (fromWall) {
    vec3 closed = step(vec3(kOpaque), vec3(x.a, y.a, z.a)) * vec3(equal(floor(apex), floor(at)));
    weights *= 1.0 - closed * step(0.0, direction * (apex - floor(apex) - 0.5));
  }
  vec4 mean = weights.x * x + weights.y * y + weights.z * z;
  if (mean.a <= 0.0) return vec4(0.0);
  const float kClosed = 1e-30;  // avoids log2(0) for an opaque wall parallel to the cone
  vec3 through = log2(max(1.0 - vec3(x.a, y.a, z.a), kClosed));
  float opacity = 1.0 - exp2(dot(through, weights) * lengths);
  return vec4(mean.rgb * (opacity / mean.a), opacity);
}

#endif
