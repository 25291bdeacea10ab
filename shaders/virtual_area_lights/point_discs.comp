#version 450
// Points as surface lights without flux, which occlude other points.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "common/rsm.glsl"
#include "surface_points.glsl"

layout(std430, binding = 0) writeonly buffer Discs { SurfaceLight discs[]; };

void main() {
  uint index = listIndex();
  if (index >= uint(pointCount)) return;
  ivec2 texel = pointTexel(index);
  float radius = texelFetch(pointRadius, texel, 0).x;
  discs[index] = SurfaceLight(vec4(texelFetch(pointPosition, texel, 0).xyz, kPi * radius * radius),
                              vec4(texelFetch(pointNormal, texel, 0).xyz, 0.0), vec4(0.0));
}
