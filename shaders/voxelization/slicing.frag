#version 450
// Fang & Chen 2000 (thesis 004 Sec. 2.1.1): the part of the scene between the clip planes of a slice; each pixel is a voxel of the slice.
// Deviates: a list of fragments instead of one image per slice, so that a voxel with several surfaces keeps all of them.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#include "view_sample.glsl"
#include "fragment_list.glsl"

void main() {
  VoxelFragment fragment = sampleView();
  if (fragment.albedoBCoverage >> 16 == 0u) discard;
  ivec3 voxel = ivec3(gl_FragCoord.xy, int(depthLow));
  ivec3 cell = unpermute(voxel, axis);
  if (any(greaterThanEqual(cell, resolution))) discard;
  fragment.voxel = packVoxel(cell);
  fragment.offset = packOffset(unpermute(vec3(gl_FragCoord.xy, posView.z) - vec3(voxel), axis));
  uint index = atomicAdd(fragmentCount, 1u);
  if (index < uint(capacity)) fragments[index] = fragment;
}
