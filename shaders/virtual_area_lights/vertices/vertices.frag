#version 450
// Sec. 3.2 step 4 as published: the averaged light of vertices, interpolated by rasterisation, on the visible side.
#pragma lumivox axis MASKS 0 1
#include "common/scene.glsl"
#include "common/visible_surface.glsl"

layout(binding = 6) uniform sampler2D gNormal;

layout(location = 0) in vec3 posWorld;
layout(location = 1) in vec3 normalWorld;
layout(location = 2) in vec4 frontLight;
layout(location = 3) in vec4 frontOffset;
layout(location = 4) in vec4 backLight;
layout(location = 5) in vec4 backOffset;
#if MASKS
layout(location = 6) in vec2 texcoord;
#endif

layout(location = 0) out vec4 outLight;
layout(location = 1) out vec4 outPlace;

void main() {
#if MASKS
  bool hidden = isHole(texcoord);
#else
  bool hidden = false;
#endif
  if (hidden || isElsewhere(posWorld)) discard;
  // The g-buffer's normal is the normal of the surface, turned to the visible side.
  bool isFront = dot(normalWorld, texelFetch(gNormal, ivec2(gl_FragCoord.xy), 0).xyz) >= 0.0;
  vec4 light = isFront ? frontLight : backLight, offset = isFront ? frontOffset : backOffset;
  // Vertices without light have weight 0.
  outLight = offset.w > 0.0 ? light / offset.w : vec4(0.0);
  outPlace = vec4(offset.w > 0.0 ? posWorld + offset.xyz / offset.w : posWorld, 1.0);
}
