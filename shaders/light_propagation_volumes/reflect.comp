#version 450
// The reflection grid (thesis 004 Sec. 4.3.4, Listing 4.34): the light that leaves the surfaces in the voxels of a finer grid. One dispatch
// per grid of propagated light, the coarsest first.
// Deviates: Listing 4.34 multiplies the albedo by the mean of the light from all sides. Here a voxel emits the flux that crosses the face
// in front of it outwards, which is exactly the light that its surface reflects.
#include "cells.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

#include "cell_grid.glsl"
layout(std140, binding = 0) uniform Parameters {
  float blend;        // cells
  vec3 reflectionLow;  // m
  float voxelSize;    // m
  int first, last;
  int fades;          // 1: the grid ends within the scene: light and opacity fade out before its border
  float fadeWidth;    // voxels
};
layout(binding = 0) uniform sampler3D red;
layout(binding = 1) uniform sampler3D green;
layout(binding = 2) uniform sampler3D blue;
layout(binding = 3) uniform sampler3D surfaceAlbedo;
layout(binding = 4) uniform sampler3D surfaceNormal;
layout(binding = 0, rgba32f) uniform image3D radianceImage;

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, imageSize(radianceImage)))) return;
  float coverage = texelFetch(surfaceAlbedo, voxel, 0).a;
  if (coverage <= 0.0) {
    if (first != 0) imageStore(radianceImage, voxel, vec4(0.0));
    return;
  }
  vec3 radiance = first != 0 ? vec3(0.0) : imageLoad(radianceImage, voxel).rgb;
  vec3 mean = texelFetch(surfaceNormal, voxel, 0).xyz;
  // One cell in front of the surface. If the normals of a voxel disagree, their mean is short, and the light of all sides counts.
  vec3 position = (reflectionLow + (vec3(voxel) + 0.5) * voxelSize - gridLow) / cellSize;
  vec3 inside = min(position, vec3(resolution) - position);
  float toBorder = min(inside.x, min(inside.y, inside.z));
  float weight = first != 0 ? 1.0 : clamp((toBorder - 1.0) / blend, 0.0, 1.0);
  if (weight > 0.0) {
    vec3 texcoord = (position + mean) / vec3(resolution);
    vec3 flux = vec3(fluxAcross(texture(red, texcoord), mean), fluxAcross(texture(green, texcoord), mean), fluxAcross(texture(blue, texcoord), mean));
    radiance = mix(radiance, max(flux, 0.0) / (kPi * cellSize * cellSize), weight);
  }
  float opacity = 0.0;
  if (last != 0) {
    float fade = 1.0;
    if (fades != 0) {
      vec3 toEnd = min(vec3(voxel) + 0.5, vec3(imageSize(radianceImage)) - vec3(voxel) - 0.5);
      fade = clamp(min(toEnd.x, min(toEnd.y, toEnd.z)) / fadeWidth, 0.0, 1.0);
    }
    opacity = coverage * fade;
    radiance *= opacity;  // pre-multiplied
  }
  imageStore(radianceImage, voxel, vec4(radiance, opacity));
}
