// Voxels as printed (thesis 004 Listings 4.26 to 4.30): what wins an atomic maximum, five words each. The first is the albedo over pi in
// three bytes, above it the contrast in seven bits, and the highest bit tells that there is a surface. The others, one for each face of a
// tetrahedron, are a normal in nine bits an axis, the higher ones of x, and above it its closeness to the face in five bits; 0: none.
// All numbers are cut off, as printed, so that a decoded normal is a little shorter than 1.
#include "common/constants.glsl"
#include "tetrahedron.glsl"

struct PackedVoxel {
  uint albedo;
  uint directions[4];
};
const uint kOccupied = 1u << 31;

uint packAlbedo(vec3 albedo) {
  uvec3 bytes = uvec3(clamp(albedo / kPi, 0.0, 1.0) * 255.0);
  return kOccupied | uint(contrastOf(albedo) * 127.0) << 24 | bytes.r << 16 | bytes.g << 8 | bytes.b;
}
vec3 unpackAlbedo(uint word) { return vec3(word >> 16 & 255u, word >> 8 & 255u, word & 255u) / 255.0; }

uint packAxis(float value) {
  int steps = int(value * 255.0);
  return (steps < 0 ? 256u : 0u) | uint(abs(steps));
}
float unpackAxis(uint bits) { return float(bits & 255u) / ((bits & 256u) != 0u ? -255.0 : 255.0); }

uint packDirection(vec3 normal, int face) {
  uint closeness = uint(clamp(dot(normal, kTetrahedron[face]), 0.0, 1.0) * 31.0);
  return closeness << 27 | packAxis(normal.x) << 18 | packAxis(normal.y) << 9 | packAxis(normal.z);
}
vec3 unpackDirection(uint word) { return vec3(unpackAxis(word >> 18), unpackAxis(word >> 9), unpackAxis(word)); }

// The closest of a voxel's four normals to a direction. A face without a normal takes part as a vector of length 0: where all others look
// away, it is the closest.
vec3 closestNormal(uvec4 directions, vec3 direction) {
  vec3 closest = unpackDirection(directions[0]);
  for (int i = 1; i < 4; ++i) {
    vec3 normal = unpackDirection(directions[i]);
    if (dot(normal, direction) > dot(closest, direction)) closest = normal;
  }
  return closest;
}
