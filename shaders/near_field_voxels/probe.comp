#version 450
// One ray per pixel through the bits, for tests and measurements.
#pragma lumivox axis PLANES 0 1
#pragma lumivox require !PLANES || BIT_RULE != printed
#include "common/bit_rays.glsl"
#if PLANES
#include "common/voxel_planes.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D origins;     // xyz posWorld, w reach, m; below 0: no ray
layout(binding = 1) uniform sampler2D directions;  // xyz unit
layout(binding = 0, rgba32f) uniform writeonly image2D voxelImage;   // xyz the voxel, -1 if there is none; w distance to it, m
layout(binding = 1, rgba32f) uniform writeonly image2D fetchImage;   // r texels of the stacks that were read

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(origins, 0)))) return;
  vec4 origin = texelFetch(origins, pixel, 0);
  BitHit hit = BitHit(ivec3(-1), kNever, false, 0);
  if (origin.w >= 0.0)
    hit = firstBit((origin.xyz - gridLow) / voxelSize, texelFetch(directions, pixel, 0).xyz, origin.w / voxelSize, resolution);
  imageStore(voxelImage, pixel, hit.found ? vec4(hit.voxel, hit.t * voxelSize) : vec4(-1.0));
  imageStore(fetchImage, pixel, vec4(hit.fetches));
}
