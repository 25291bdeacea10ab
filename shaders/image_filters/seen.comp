#version 450
// Keeps the visible surfaces for the next frame.

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 2) uniform sampler2D gGeometricNormal;
layout(binding = 0, rgba32f) uniform writeonly image2D seenPosition;
layout(binding = 1, rgba32f) uniform writeonly image2D seenNormal;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(seenPosition)))) return;
  imageStore(seenPosition, at, texelFetch(gPosition, at, 0));
  imageStore(seenNormal, at, texelFetch(gGeometricNormal, at, 0));
}
