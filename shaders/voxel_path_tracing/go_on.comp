#version 450
// Copies the sums of the last frame.
#include "sums.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2DArray earlierSums;

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (all(lessThan(at, imageSize(sums)))) imageStore(sums, at, texelFetch(earlierSums, at, 0));
}
