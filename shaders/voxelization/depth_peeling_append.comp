#version 450
// Appends a fragment for each pixel of a layer.
#include "fragment_list.glsl"
#include "view_axis.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// The last layer along each axis that contains a surface, counted from 1.
layout(std430, binding = 9) buffer Deepest { uint deepest[3]; };
layout(std140, binding = 0) uniform Layer { int layer; };
layout(binding = 0) uniform sampler2D layerDepth;
layout(binding = 1) uniform usampler2D layerSurface;
layout(binding = 2) uniform sampler2D layerDepthInGrid;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(layerDepth, 0))) || texelFetch(layerDepth, pixel, 0).r >= 1.0) return;
  atomicMax(deepest[axis], uint(layer) + 1u);
  float depth = texelFetch(layerDepthInGrid, pixel, 0).r;
  ivec3 voxel = ivec3(pixel, int(floor(depth)));
  ivec3 cell = unpermute(voxel, axis);
  if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, resolution))) return;
  uvec4 surface = texelFetch(layerSurface, pixel, 0);
  VoxelFragment fragment;
  fragment.voxel = packVoxel(cell);
  fragment.offset = packOffset(unpermute(vec3(vec2(0.5), depth - float(voxel.z)), axis));
  fragment.normal = surface.x;
  fragment.albedoRg = surface.y;
  fragment.albedoBCoverage = surface.z;
  fragment.emission = surface.w;
  uint index = atomicAdd(fragmentCount, 1u);
  if (index < uint(capacity)) fragments[index] = fragment;
}
