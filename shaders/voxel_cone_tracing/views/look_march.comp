#version 450
// Ray and cone casting through emitting and absorbing voxels, filtered between their centres: thesis 004 Sec. 2.3, Fig. 14 and 57.
#pragma lumivox require SOURCE == texels && OPACITY == solid
#include "toolkit/voxel_rays.glsl"
#include "toolkit/voxel_transfer.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const int kNearest = 0, kTrilinear = 1;
layout(constant_id = 0) const int filterRule = kNearest;
layout(constant_id = 1) const int castsCones = 0;

layout(std140, binding = 3) uniform March {
  float stepShare;  // step as a share of a voxel, or of a cone's voxels
  float coarsest;   // level
};
layout(binding = 4) uniform sampler3D classified;
layout(binding = 0, rgba32f) uniform writeonly image2D radianceImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radianceImage)))) return;
  float perDepth;
  vec3 direction = rayOf(pixel, perDepth), extent = voxelSides * vec3(gridResolution);
  vec2 inside = insideVolume(gridLow, extent, eye, direction);
  float distance = max(inside.x, cut * perDepth), finest = shortestSide();
  vec4 seen = vec4(0.0);
  while (distance < inside.y && seen.a < kOpaque) {
    float size = castsCones != 0 ? max(pixelWidth * (1.0 / perDepth) * distance / finest, 1.0) : 1.0, blend;
    float level = levelOf(size, coarsest, blend);
    float stride = min(stepShare * size * finest, inside.y - distance);
    vec3 texcoord = (eye + direction * (distance + 0.5 * stride) - gridLow) / extent;
    // Coarser levels are means of opacities per length of a finest voxel, so every level has opacity per that length.
    vec4 value;
    if (filterRule == kNearest) {
      ivec3 voxels = textureSize(classified, int(level));
      value = texelFetch(classified, clamp(ivec3(texcoord * vec3(voxels)), ivec3(0), voxels - 1), int(level));
    } else {
      value = textureLod(classified, texcoord, level + blend);
    }
    addLengths(seen, value, stride / finest, 1.0);
    distance += stride;
  }
  imageStore(radianceImage, pixel, beforeBackground(seen));
}
