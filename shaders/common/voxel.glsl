// Voxel addressing and the fragment list. Voxel (i,j,k) covers gridLow + [i,i+1] x [j,j+1] x [k,k+1] voxel sizes.
// C++ side: GridPlacement and VoxelFragments in framework/include/lumivox/pipeline/ports/.
#ifndef LUMIVOX_VOXEL
#define LUMIVOX_VOXEL

// One surface sample: a triangle inside a voxel.
struct VoxelFragment {
  uint voxel;     // i, j, k in 10 bits each
  uint offset;    // position inside the voxel, 10 bits each; kSeenBehind
  uint normal;    // octahedral, two 16-bit signed normalised numbers; front side
  uint albedoRg;  // two halves
  uint albedoBCoverage;  // halves: blue albedo; covered fraction (alpha mask)
  uint emission;  // radiance, W/(sr m^2), three mantissas with a shared exponent; or the Phong lobe of a surface that does not emit
};

// A triangle with a sharper corner than this, in radians, is a needle: its plane and its enlarged corners are mostly rounding error.
const float kNeedle = 1e-3;

uint packVoxel(ivec3 voxel) { return uint(voxel.x) | uint(voxel.y) << 10 | uint(voxel.z) << 20; }
ivec3 unpackVoxel(uint word) { return ivec3(word & 1023u, word >> 10 & 1023u, word >> 20 & 1023u); }

uint packOffset(vec3 offset) {
  uvec3 steps = uvec3(clamp(offset, 0.0, 1.0) * 1023.0 + 0.5);
  return steps.x | steps.y << 10 | steps.z << 20;
}
vec3 unpackOffset(uint word) { return vec3(unpackVoxel(word)) / 1023.0; }

// Two numbers of [-1, 1] as 16-bit signed normalised ones, the first in the low bits, and back (OpenGL 4.5, 2.3.5): the bits of the
// built-in packSnorm2x16, which not every driver has.
uint packSigned(vec2 value) {
  ivec2 steps = ivec2(roundEven(clamp(value, -1.0, 1.0) * 32767.0));
  return uint(steps.x) & 0xffffu | uint(steps.y) << 16;
}
vec2 unpackSigned(uint word) {
  ivec2 steps = ivec2(int(word << 16), int(word)) >> 16;  // keeps the sign
  return max(vec2(steps) / 32767.0, -1.0);
}

// packHalf2x16 with rounding to the nearest half-precision number, ties to even. The driver chooses the rounding of the built-in, and one
// driver truncates values that were just read from a texture.
uint packHalves(vec2 value) {
  const float kLeastNormal = 1.0 / 16384.0, kStepBelow = 1.0 / 16777216.0;
  uvec2 bits = floatBitsToUint(value);
  vec2 nearest = uintBitsToFloat(bits + 0xfffu + (bits >> 13 & 1u) & ~0x1fffu);  // clears the lowest 13 bits
  return packHalf2x16(mix(nearest, roundEven(value / kStepBelow) * kStepBelow, lessThan(abs(value), vec2(kLeastNormal))));
}

// Octahedral unit vectors (Cigolle et al. 2014, "Survey of efficient representations for independent unit vectors", Sec. 3.3).
uint packNormal(vec3 normal) {
  vec2 p = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
  if (normal.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
  return packSigned(p);
}
vec3 unpackNormal(uint word) {
  vec2 p = unpackSigned(word);
  vec3 normal = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (normal.z < 0.0) normal.xy = (1.0 - abs(normal.yx)) * vec2(normal.x >= 0.0 ? 1.0 : -1.0, normal.y >= 0.0 ? 1.0 : -1.0);
  return normalize(normal);
}

// Non-negative values of any magnitude, 8 bits each and a shared exponent (Ward 1991, "Real pixels"). The error of each value is at most
// 1/256 of the largest value.
uint packShared(vec3 value) {
  float largest = max(value.x, max(value.y, value.z));
  if (!(largest > 0.0)) return 0u;
  int exponent = clamp(int(floor(log2(largest))) + 1, -100, 127);
  // The logarithm of a power of two may be off by one.
  if (largest >= exp2(float(exponent))) ++exponent;
  uvec3 mantissa = uvec3(clamp(value * exp2(float(8 - exponent)) + 0.5, 0.0, 255.0));
  return mantissa.x | mantissa.y << 8 | mantissa.z << 16 | uint(exponent + 128) << 24;
}
vec3 unpackShared(uint word) {
  if (word == 0u) return vec3(0.0);
  float unit = exp2(float(int(word >> 24) - 128 - 8));
  return vec3(word & 255u, word >> 8 & 255u, word >> 16 & 255u) * unit;
}

// What a surface emits or, if it emits nothing, its Phong lobe: the albedo in 8 bits a channel and the exponent in one of 27 steps of
// log2(exponent + 1), below the exponents of all radiances. Of a surface that does both, the lobe is left out.
const uint kLobeSteps = 27u;
const float kLobeStep = 16.0 / 26.0;
uint packEmissionOrLobe(vec3 emission, vec4 specular) {
  uint word = packShared(emission);
  uvec3 albedo = uvec3(clamp(specular.rgb, 0.0, 1.0) * 255.0 + 0.5);
  uint all = albedo.r | albedo.g << 8 | albedo.b << 16;
  if (word != 0u || all == 0u) return word;
  float width = log2(max(specular.w, 0.0) + 1.0) / kLobeStep;
  return all | uint(clamp(width + 1.5, 1.0, float(kLobeSteps))) << 24;
}
vec3 emissionOf(VoxelFragment fragment) { return fragment.emission >> 24 > kLobeSteps ? unpackShared(fragment.emission) : vec3(0.0); }
// rgb: Phong albedo, 0 where there is no lobe; w: exponent.
vec4 lobeOf(VoxelFragment fragment) {
  uint step = fragment.emission >> 24;
  if (step == 0u || step > kLobeSteps) return vec4(0.0);
  vec3 albedo = vec3(fragment.emission & 255u, fragment.emission >> 8 & 255u, fragment.emission >> 16 & 255u) / 255.0;
  return vec4(albedo, exp2(float(step - 1u) * kLobeStep) - 1.0);
}

// The direct light that the fragment reflects is not known: the reader lights the fragment itself (VoxelFragments::kNotKnown).
const uint kNotKnown = 0xffffffffu;
// Bit of VoxelFragment::offset: the known light leaves the fragment on the back of its normal, the side that the camera saw.
const uint kSeenBehind = 1u << 30;

#endif
