#version 450
// Values at vertices, interpolated by rasterisation, on the visible side. w 1: the pixel has a value.
#pragma lumivox axis MASKS 0 1
#include "common/scene.glsl"
#include "common/visible_surface.glsl"

layout(binding = 6) uniform sampler2D gNormal;

layout(location = 0) in vec3 posWorld;
layout(location = 1) in vec3 normalWorld;
layout(location = 2) in vec3 front;
layout(location = 3) in vec3 back;
layout(location = 4) in float known;
#if MASKS
layout(location = 5) in vec2 texcoord;
#endif

layout(location = 0) out vec4 outValue;

void main() {
#if MASKS
  bool hidden = isHole(texcoord);
#else
  bool hidden = false;
#endif
  if (hidden || isElsewhere(posWorld)) discard;
  // The g-buffer's normal is the normal of the surface, turned to the visible side.
  vec3 seen = texelFetch(gNormal, ivec2(gl_FragCoord.xy), 0).xyz;
  vec3 value = dot(normalWorld, seen) >= 0.0 ? front : back;
  // Vertices without an element have weight 0.
  outValue = known > 0.0 ? vec4(value / known, 1.0) : vec4(0.0);
}
