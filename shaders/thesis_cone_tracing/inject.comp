#version 450
// Listings 4.8 and 4.9: the light reflected by the front of a fragment goes into a running average of its voxel, in 8 bits per channel. The
// last channel counts the fragments modulo 256: the 256th fragment resets it to 0, and the next one starts a new average. The average
// depends on the order of the fragments, and so does every image computed from it. Deviates: stores radiance, albedo / pi times irradiance,
// in units of the radiance of the largest byte, and clamped to it; the listing stores colours, and brighter colours wrap.
//
// GRIDS six: the same average in each of six grids, one after another. The thesis does not print how
// the faces of the finest voxels are filled.
#pragma lumivox axis GRIDS one six
#pragma lumivox axis LIGHTS 0 1

layout(local_size_x = 64) in;
#include "common/constants.glsl"
#include "common/fragments.glsl"
#if LIGHTS
#define SHADOW_VIEWS
#include "common/lights.glsl"
#include "common/two_sided_light.glsl"
#endif

layout(std140, binding = 0) uniform Grid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  int lightCount;
  float largest;    // radiance of the largest byte, W/(sr m^2)
  float ambient;    // irradiance of all surfaces in addition to the lights, W/m^2
};
layout(binding = 0, r32ui) uniform coherent volatile uimage3D averages;
#if GRIDS == GRIDS_SIX
layout(binding = 1, r32ui) uniform coherent volatile uimage3D averages1;
layout(binding = 2, r32ui) uniform coherent volatile uimage3D averages2;
layout(binding = 3, r32ui) uniform coherent volatile uimage3D averages3;
layout(binding = 4, r32ui) uniform coherent volatile uimage3D averages4;
layout(binding = 5, r32ui) uniform coherent volatile uimage3D averages5;
#endif

vec4 bytesOf(uint word) { return vec4(word & 0xffu, word >> 8 & 0xffu, word >> 16 & 0xffu, word >> 24); }
uint wordOf(vec4 bytes) {
  uvec4 cut = uvec4(bytes) & 0xffu;
  return cut.x | cut.y << 8 | cut.z << 16 | cut.w << 24;
}

// The average with one more value: the stored average is multiplied by its count, and the new sum divided by the next count. The whole
// part of the quotient is exact: a division may be off by its last bits (GLSL 4.50, Sec. 4.7.1), and would then take 1 off the average with
// every fragment that does not change it.
uint averaged(uint stored, vec4 value) {
  vec4 sum = bytesOf(stored);
  sum.rgb *= sum.a;
  sum += value;
  vec3 average = floor(sum.rgb / sum.a);
  average += vec3(lessThanEqual((average + 1.0) * sum.a, sum.rgb)) - vec3(greaterThan(average * sum.a, sum.rgb));
  return wordOf(vec4(average, sum.a));
}

// A macro, because not every compiler can pass images to a function.
#define ADD_TO(grid)                                                                   \
  {                                                                                    \
    uint expected = 0u, wanted = wordOf(value), found;                                 \
    while ((found = imageAtomicCompSwap(grid, voxel, expected, wanted)) != expected) { \
      expected = found;                                                                \
      wanted = averaged(found, value);                                                 \
    }                                                                                  \
  }

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  vec3 arriving = vec3(0.0);
#if LIGHTS
  vec3 low = gridLow + vec3(voxel) * voxelSize, behind = vec3(0.0);
  addArriving(lightCount, low + unpackOffset(fragment.offset) * voxelSize, unpackNormal(fragment.normal), false, 0, arriving, behind);
#endif
  vec3 albedo = vec3(unpackHalf2x16(fragment.albedoRg), unpackHalf2x16(fragment.albedoBCoverage).x);
  vec4 value = vec4(min(albedo / kPi * (ambient + arriving) / largest, 1.0) * 255.0, 1.0);
  ADD_TO(averages)
#if GRIDS == GRIDS_SIX
  ADD_TO(averages1)
  ADD_TO(averages2)
  ADD_TO(averages3)
  ADD_TO(averages4)
  ADD_TO(averages5)
#endif
}
