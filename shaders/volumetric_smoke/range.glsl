// The camera's rays through the media, shared by marching and upsampling.
#ifndef LUMIVOX_SMOKE_RANGE
#define LUMIVOX_SMOKE_RANGE
#include "common/media.glsl"

layout(std140, binding = 1) uniform View {
  vec3 eyeWorld;
  int pixelsPerSample;  // 1: one sample per pixel; 2: one sample per 2 x 2 pixels
  vec3 cornerDirection; // of the image's upper left corner; the forward component is 1
  vec3 perColumn;       // change of direction per pixel to the right; perRow: downwards
  vec3 perRow;
};
layout(binding = 0) uniform sampler2D gPosition;

// The pixel of a sample's ray: neighbouring samples use different pixels of their 2 x 2 pixels.
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
