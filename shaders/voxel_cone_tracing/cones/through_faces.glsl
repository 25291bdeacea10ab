// What a cone sees of the three faces of a voxel whose normals are against it: Crassin et al. 2011, Sec. 8.1; thesis 004, Listing 4.15.
#ifndef LUMIVOX_THROUGH_FACES
#define LUMIVOX_THROUGH_FACES

vec3 faceWeights(vec3 direction) {
  vec3 along = abs(direction);
  return along / (along.x + along.y + along.z);
}

// What a step of `lengths` voxels through a level sees of three faces, those across x, y and z, where each is the layer of voxels across its
// axis that the middle of the step lies in: what the faces let through is multiplied, with the printed weights as exponents. `at` and `apex`
// are the middle of the step and the apex of the cone in voxels; `fromWall`: the level is the finest where the cone begins.
vec4 throughFaces(vec4 x, vec4 y, vec4 z, vec3 direction, vec3 at, vec3 apex, bool fromWall, float lengths) {
  vec3 weights = faceWeights(direction);
  // In the edge of a room a cone begins in the layer of a wall beside it. The wall lies in the middle of its layer as far as is known: a
  // cone that leaves the middle does not meet it.
  if (fromWall) {
    vec3 closed = step(vec3(kOpaque), vec3(x.a, y.a, z.a)) * vec3(equal(floor(apex), floor(at)));
    weights *= 1.0 - closed * step(0.0, direction * (apex - floor(apex) - 0.5));
  }
  vec4 mean = weights.x * x + weights.y * y + weights.z * z;
  if (mean.a <= 0.0) return vec4(0.0);
  const float kClosed = 1e-30;  // keeps what a cone along a wall sees of the wall finite
  vec3 through = log2(max(1.0 - vec3(x.a, y.a, z.a), kClosed));
  float opacity = 1.0 - exp2(dot(through, weights) * lengths);
  return vec4(mean.rgb * (opacity / mean.a), opacity);
}

#endif
