// A transfer function: the emission and opacity of each voxel of a field (thesis 004 Sec. 2.3), and the light that a ray collects.
// C++ side: VoxelTransfer in framework/include/lumivox/toolkit/voxel_view.h.
#ifndef LUMIVOX_VOXEL_TRANSFER
#define LUMIVOX_VOXEL_TRANSFER
#pragma lumivox axis OPACITY solid field absorption
#include "common/cones.glsl"
#include "toolkit/voxel_field.glsl"

layout(std140, binding = 2) uniform TransferParameters {
  float rampLow, rampHigh;  // values at its ends; low above high: no ramp
  float absorption;         // 1/m at the value 1
  int opacityComponent;
  int opacityLevel;
  int isMultiplied;         // 1: colours are pre-multiplied by the opacity
  int isDirection;          // 1: -1..1 are shown as 0..1
};
#if OPACITY == OPACITY_FIELD
layout(binding = 3) uniform sampler3D fieldOpacity;
#endif

// Black, blue, green, yellow, white: brightness rises along it.
vec3 rampOf(float share) {
  const vec3 kStops[5] = vec3[](vec3(0.0), vec3(0.05, 0.1, 0.7), vec3(0.0, 0.6, 0.3), vec3(0.95, 0.85, 0.1), vec3(1.0));
  float place = clamp(share, 0.0, 1.0) * 4.0;
  int stop = min(int(place), 3);
  return mix(kStops[stop], kStops[stop + 1], place - float(stop));
}

// Emission, pre-multiplied by the opacity, and the opacity of a length equal to the shortest side of a voxel.
vec4 transferOf(ivec3 voxel) {
  vec3 value = fieldValue(voxel);
  float size = fieldChannels == 3 ? length(value) : value.x;
#if OPACITY == OPACITY_SOLID
  float opacity = size != 0.0 ? 1.0 : 0.0;
#elif OPACITY == OPACITY_FIELD
  float opacity = clamp(texelFetch(fieldOpacity, voxel, opacityLevel)[opacityComponent], 0.0, 1.0);
#else
  float opacity = 1.0 - exp(-absorption * abs(size) * shortestSide());
#endif
  if (rampLow < rampHigh) return vec4(rampOf((size - rampLow) / (rampHigh - rampLow)) * opacity, opacity);
  vec3 colour = isDirection != 0 ? 0.5 + 0.5 * value : max(value, 0.0);
  return vec4(colour * (isMultiplied != 0 ? 1.0 : opacity), opacity);
}

// Composites a step through a voxel behind what is seen so far; `lengths`: length of the step in shortest sides.
void addLengths(inout vec4 seen, vec4 voxel, float lengths, float brightness) {
  if (voxel.a <= 0.0) {
    // A voxel without absorption emits in proportion to the length.
    seen.rgb += (1.0 - seen.a) * brightness * lengths * voxel.rgb;
    return;
  }
  float opacity = stepOpacityOf(max(1.0 - voxel.a, 0.0), lengths);
  seen += (1.0 - seen.a) * vec4(brightness * opacity / voxel.a * voxel.rgb, opacity);
}

#endif
