// Voxel addressing and the fragment list. Voxel (i,j,k) covers gridLow + [i,i+1] x [j,j+1] x [k,k+1] voxel sizes.
// C++ side: GridPlacement and VoxelFragments in framework/include/lumivox/pipeline/ports.h.
#ifndef LUMIVOX_VOXEL
#define LUMIVOX_VOXEL

// One surface sample: a triangle inside a voxel.
struct VoxelFragment {
  uint voxel;     // i, j, k in 10 bits each
  uint offset;    // position inside the voxel, 10 bits each
  uint normal;    // octahedral, two 16-bit signed normalised numbers; front side
  uint albedoRg;  // two halves
  uint albedoBCoverage;  // halves: blue albedo; covered fraction (alpha mask)
};

// A triangle with sharper corners than this, in radians, is a needle: its plane and its enlarged corners are mostly rounding.
const float kNeedle = 1e-3;

// Shares of averages are added up as integers of this unit, so that a full sum fits into 32 bits.
const float kFixedPoint = 2147483648.0;  // 2^31

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

#endif
