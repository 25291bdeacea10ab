#version 450
// Every pixel that sees a surface marks the voxel that contains it. All write the same value, so their order does not
// matter.
#include "grid.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 0, r8) uniform writeonly image3D seenImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  if (position.w != 0.0) imageStore(seenImage, voxelAt(position.xyz), vec4(1.0));
}
