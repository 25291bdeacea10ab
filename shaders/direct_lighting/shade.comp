#version 450
// Direct light at the visible surfaces, with the visibility of shadow maps.
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis SHADOWS 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox axis EMISSION 0 1
#pragma lumivox axis MEDIUM none even varying
#pragma lumivox require !SHADOWS || LIGHTS
#pragma lumivox require MEDIUM == none || LIGHTS
#if SHADOWS
#define SHADOW_VIEWS
#endif
#include "common/environment_seen.glsl"
#include "common/direct_light.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) uniform writeonly image2D radianceImage;

#if LIGHTS
float visibleShare(int i, LightSample light, vec3 posWorld, vec3 geometricNormal, vec3 toLight) {
#if SHADOWS
  return visibility(light, posWorld, geometricNormal, toLight);
#else
  return 1.0;
#endif
}
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radianceImage)))) return;
  imageStore(radianceImage, pixel, vec4(directLight(pixel), 1.0));
}
