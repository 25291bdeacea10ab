#version 450
// Shows whether a pixel's surface lies in a marked voxel.
#include "grid.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler3D seen;
layout(binding = 0, rgba32f) uniform writeonly image2D shownImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(shownImage)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  float value = position.w != 0.0 ? texelFetch(seen, voxelAt(position.xyz), 0).r : 0.0;
  imageStore(shownImage, pixel, vec4(vec3(value), 1.0));
}
