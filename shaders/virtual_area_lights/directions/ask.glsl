// Asks the directions of a point light by light. Included where `nearest` may be read.
#ifndef LUMIVOX_ASK
#define LUMIVOX_ASK
#include "sight.glsl"

layout(std430, binding = 1) readonly buffer Sight { uint nearest[]; };

// A light this far behind an occluder's plane still lies on its surface, in radii of its disc.
const float kOnSurface = 0.5;

// Whether one direction of a point shows a light: it is nearer than the nearest disc there, or on its surface.
bool showsLight(uint entry, float distance, vec3 light) {
  if (entry == kSeesNothing || distance <= sightDistance(entry)) return true;
  ivec2 disc = pointTexel(sightPoint(entry));
  float behind = dot(texelFetch(pointPosition, disc, 0).xyz - light, texelFetch(pointNormal, disc, 0).xyz);
  return behind <= kOnSurface * texelFetch(pointRadius, disc, 0).x;
}

// Visible share of a light at `offset` from a point, linear between the four directions around it.
float visibleShare(uint point, vec3 light, vec3 offset, vec3 tangent, vec3 binormal) {
  float distance = length(offset);
  vec2 disc = vec2(dot(offset, tangent), dot(offset, binormal)) / distance;
  vec2 at = squareFromDisc(disc) * float(kSightSide) - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 share = at - vec2(low);
  float visible = 0.0;
  for (int corner = 0; corner < 4; ++corner) {
    ivec2 step = ivec2(corner & 1, corner >> 1), cell = clamp(low + step, ivec2(0), ivec2(kSightSide - 1));
    vec2 weight = mix(1.0 - share, share, vec2(step));
    if (showsLight(nearest[int(point) * kSightSide * kSightSide + cell.y * kSightSide + cell.x], distance, light))
      visible += weight.x * weight.y;
  }
  return visible;
}
#endif
