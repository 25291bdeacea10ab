// Texels of the map as lights.
#ifndef LUMIVOX_TAKEN
#define LUMIVOX_TAKEN
#include "common/rsm.glsl"
#include "cross_section.glsl"

layout(binding = 0) uniform sampler2DArray rsmPosition;
layout(binding = 1) uniform sampler2DArray rsmNormal;
layout(binding = 2) uniform sampler2DArray rsmFlux;
layout(std430, binding = 1) writeonly buffer Taken { SurfaceLight taken[]; };

// A texel that stands for so many like it. `facing`: with the area that it would have if it faced the light (Lensing and Broll 2013,
// Sec. 4.1), in place of that of the surface.
SurfaceLight texelLight(ivec3 texel, float copies, bool facing) {
  vec4 normalArea = texelFetch(rsmNormal, texel, 0), flux = texelFetch(rsmFlux, texel, 0);
  vec3 posWorld = texelFetch(rsmPosition, texel, 0).xyz;
  float area = normalArea.w;
  if (facing && area > 0.0)
    area = crossSectionOf(lights[int(flux.w)], posWorld, vec2(texel.xy) + 0.5 - 0.5 * float(textureSize(rsmFlux, 0).x));
  return SurfaceLight(vec4(posWorld, area * copies), vec4(normalArea.xyz, 0.0), vec4(flux.rgb * copies, 0.0));
}

#endif
