// Voxel addressing and the fragment list. Voxel (i,j,k) covers gridLow + [i,i+1] x [j,j+1] x [k,k+1] voxel sizes.
// C++ side: GridPlacement and VoxelFragments in framework/include/lumivox/pipeline/ports/.
#ifndef LUMIVOX_VOXEL
#define LUMIVOX_VOXEL

// One surface sample: a triangle inside a voxel.
struct VoxelFragment {
  uint voxel;     // i, j, k in 10 bits each
  uint offset;    // position inside the voxel, 10 bits each
  uint normal;    // octahedral, two 16-bit signed normalised numbers; front side
  uint albedoRg;  // two halves
  uint albedoBCoverage;  // halves: blue albedo; covered fraction (alpha mask)
  uint emission;  // radiance, W/(sr m^2), three mantissas with a shared exponent
};

// A triangle with sharper corners than this, in radians, is a needle: its plane and its enlarged corners are mostly rounding.
const float kNeedle = 1e-3;

uint packVoxel(ivec3 voxel) { return uint(voxel.x) | uint(voxel.y) << 10 | uint(voxel.z) << 20; }
ivec3 unpackVoxel(uint packed) { return ivec3(packed & 1023u, packed >> 10 & 1023u, packed >> 20 & 1023u); }

uint packOffset(vec3 offset) {
  uvec3 steps = uvec3(clamp(offset, 0.0, 1.0) * 1023.0 + 0.5);
  return steps.x | steps.y << 10 | steps.z << 20;
}
vec3 unpackOffset(uint packed) { return vec3(unpackVoxel(packed)) / 1023.0; }

// Octahedral unit vectors (Cigolle et al. 2014, "Survey of efficient representations for independent unit vectors", Sec. 3.3).
uint packNormal(vec3 normal) {
  vec2 p = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
  if (normal.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
  return packSnorm2x16(p);
}
vec3 unpackNormal(uint packed) {
  vec2 p = unpackSnorm2x16(packed);
  vec3 normal = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (normal.z < 0.0) normal.xy = (1.0 - abs(normal.yx)) * vec2(normal.x >= 0.0 ? 1.0 : -1.0, normal.y >= 0.0 ? 1.0 : -1.0);
  return normalize(normal);
}

// Non-negative values of any magnitude, 8 bits each beside a shared exponent (Ward 1991, "Real pixels"): the largest is right to 1/256,
// the others to 1/256 of the largest.
uint packShared(vec3 value) {
  float largest = max(value.x, max(value.y, value.z));
  if (!(largest > 0.0)) return 0u;
  int exponent = clamp(int(floor(log2(largest))) + 1, -100, 127);
  // The logarithm of a power of two may be off by one.
  if (largest >= exp2(float(exponent))) ++exponent;
  uvec3 mantissa = uvec3(clamp(value * exp2(float(8 - exponent)) + 0.5, 0.0, 255.0));
  return mantissa.x | mantissa.y << 8 | mantissa.z << 16 | uint(exponent + 128) << 24;
}
vec3 unpackShared(uint packed) {
  if (packed == 0u) return vec3(0.0);
  float unit = exp2(float(int(packed >> 24) - 128 - 8));
  return vec3(packed & 255u, packed >> 8 & 255u, packed >> 16 & 255u) * unit;
}

// In place of the direct light that a fragment is known to reflect: a reader has to light it (VoxelFragments::kNotKnown).
const uint kNotKnown = 0xffffffffu;

#endif
