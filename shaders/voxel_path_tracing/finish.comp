#version 450
// Means over all paths of a pixel.
#pragma lumivox axis ARRIVING 0 1
#pragma lumivox axis REFLECTED 0 1
#pragma lumivox require ARRIVING || REFLECTED
#include "sums.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Finish {
  float paths;  // of each pixel, over all frames
};
layout(binding = 0) uniform sampler2D gPosition;
#if ARRIVING
layout(binding = 1, rgba32f) uniform writeonly image2D arrivingImage;
#endif
#if REFLECTED
layout(binding = 7) uniform sampler2D gSpecular;
layout(binding = 2, rgba32f) uniform writeonly image2D glossyImage;
#endif

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, textureSize(gPosition, 0)))) return;
  float surface = texelFetch(gPosition, at, 0).w > 0.0 ? 1.0 : 0.0;
#if ARRIVING
  imageStore(arrivingImage, at, vec4(imageLoad(sums, ivec3(at, kArriving)).rgb / paths, surface));
#endif
#if REFLECTED
  imageStore(glossyImage, at, vec4(texelFetch(gSpecular, at, 0).rgb * imageLoad(sums, ivec3(at, kReflected)).rgb / paths, 1.0));
#endif
}
