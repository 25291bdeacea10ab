// Voxels as printed (thesis 004 Listings 4.26 to 4.30): five words each, every one the winner of an atomic maximum. The first word has the
// albedo over pi in three bytes, the contrast in seven bits above it, and the highest bit set if there is a surface. The other words, one
// per face of a tetrahedron, have a normal in nine bits per axis, x highest, and above it the closeness to the face in five bits; 0: no
// normal. All numbers are truncated, as printed, so that a decoded normal is a little shorter than 1.
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

// The closest of a voxel's four normals to a direction. A face without a normal takes part as a vector of length 0, and is the closest if
// all others face away.
vec3 closestNormal(uvec4 directions, vec3 direction) {
  vec3 closest = unpackDirection(directions[0]);
  for (int i = 1; i < 4; ++i) {
    vec3 normal = unpackDirection(directions[i]);
    if (dot(normal, direction) > dot(closest, direction)) closest = normal;
  }
  return closest;
}
