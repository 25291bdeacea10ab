#version 450
// The voxels that visible surfaces read.
layout(local_size_x = 8, local_size_y = 8) in;
#include "mark.glsl"
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gGeometricNormal;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 posWorld = texelFetch(gPosition, pixel, 0);
  vec3 surface = (posWorld.xyz - gridLow) / voxelSize;
  if (posWorld.w > 0.0 && isInVolume(surface)) markReads(surface, texelFetch(gGeometricNormal, pixel, 0).xyz);
}
