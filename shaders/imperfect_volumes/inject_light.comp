#version 450
// Mavridis & Papaioannou 2011, Sec. 3.1: the direct light that each fragment reflects diffusely, on both sides; and the largest radiance in
// each voxel, the unit of inject_add.comp, so that a dark voxel beside a very bright one keeps its light. Sec. 3.2: if the image has the
// light of a visible side, that light is used (REFLECTED), and the lights illuminate only the other side. Deviates: what a Phong lobe
// reflects is added, as if it left to all sides; the paper's surfaces are diffuse.
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox require LIGHTS || REFLECTED
layout(local_size_x = 64) in;
#include "common/constants.glsl"
#if LIGHTS
#define SHADOW_VIEWS
#include "common/lights.glsl"
#include "common/two_sided_light.glsl"
#endif
#include "toolkit/slot_of_voxel.glsl"
#include "common/known_light.glsl"

layout(std140, binding = 0) uniform Lighting {
  vec3 gridLow;        // m
  float voxelSize;     // m
  int lightCount;
  float mostRadiance;  // W/(sr m^2): limit of the radiance of a voxel of this size, however near a light is
  int glossy;          // 1: what Phong lobes reflect leaves to all sides like diffuse light
};
layout(std430, binding = 2) writeonly buffer Radiances { float radiances[]; };  // W/(sr m^2): front, back, three channels each
layout(std430, binding = 3) buffer Brightest { uint brightest[]; };  // bits of a non-negative float, which order like the float

void main() {
  uint index = listIndex();
  if (index >= fragmentCount) return;
  VoxelFragment fragment = fragments[index];
  ivec3 voxel = unpackVoxel(fragment.voxel);
  vec3 posWorld = gridLow + (vec3(voxel) + unpackOffset(fragment.offset)) * voxelSize;
  vec4 lobe = vec4(0.0);
  SidesLit lit = kUnlit;
  KnownLight known = knownLightOf(index, fragment, true);
#if LIGHTS
  if (glossy != 0) lobe = lobeOf(fragment);
  float exponent = any(greaterThan(lobe.rgb, vec3(0.0))) ? lobe.w : -1.0;
  addArrivingBeside(known, lightCount, posWorld, unpackNormal(fragment.normal), exponent, true, 0, lit);
#endif
  vec3 albedo = clamp(vec3(unpackHalf2x16(fragment.albedoRg), unpackHalf2x16(fragment.albedoBCoverage).x), 0.0, 1.0);
  vec3 sides[2] = vec3[2](albedo / kPi * lit.front + lobe.rgb / kPi * lit.frontByLobe + (known.side == 0 ? known.radiance : vec3(0.0)),
                          albedo / kPi * lit.back + lobe.rgb / kPi * lit.backByLobe + (known.side == 0 ? vec3(0.0) : known.radiance));
  float most = 0.0;
  for (int side = 0; side < 2; ++side)
    for (int channel = 0; channel < 3; ++channel) {
      float radiance = min(sides[side][channel], mostRadiance);
      radiances[6 * index + 3 * side + channel] = radiance;
      most = max(most, radiance);
    }
  uint slot;
  if (slotOf(voxel, slot)) atomicMax(brightest[slot], floatBitsToUint(most));
}
