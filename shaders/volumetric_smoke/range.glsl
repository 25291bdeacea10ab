// The camera's rays through the media, shared by marching and upsampling.
#ifndef LUMIVOX_SMOKE_RANGE
#define LUMIVOX_SMOKE_RANGE
#include "common/media.glsl"

layout(std140, binding = 1) uniform View {
  vec3 eyeWorld;
  int pixelsPerSample;  // 1: a sample a pixel; 2: a sample for 2 x 2 pixels
  vec3 cornerDirection; // of the image's upper left corner; the forward component is 1
  vec3 perColumn;       // what a pixel to the right adds
  vec3 perRow;
};
layout(binding = 0) uniform sampler2D gPosition;

// The pixel that a sample looks through: another of the 2 x 2 in each of four neighbours.
ivec2 pixelOf(ivec2 texel) {
  ivec2 pixel = pixelsPerSample == 1 ? texel : 2 * texel + ivec2(texel.y & 1, texel.x & 1);
  return min(pixel, textureSize(gPosition, 0) - 1);
}

// Unit direction of a pixel's ray, and the distance to the surface or kNoReach.
vec3 rayOf(ivec2 pixel, out float reach) {
  vec4 position = texelFetch(gPosition, pixel, 0);
  if (position.w > 0.0) {
    vec3 path = position.xyz - eyeWorld;
    reach = length(path);
    return path / max(reach, 1e-30);
  }
  reach = kNoReach;
  return normalize(cornerDirection + (float(pixel.x) + 0.5) * perColumn + (float(pixel.y) + 0.5) * perRow);
}

#endif
