#version 450
// Depth peeling (Everitt 2001) as used by Li et al. 2005: surfaces no deeper than the previous layer are discarded, and the depth test
// finds the nearest of the rest. Each pixel stores the attributes of its voxel fragment.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#pragma lumivox axis FIRST 0 1
#include "view_sample.glsl"

#if !FIRST
layout(binding = 2) uniform sampler2D layerBefore;
#endif
layout(location = 0) out uvec4 surface;  // normal, two words of albedo and coverage, emission
layout(location = 1) out float depthInGrid;  // voxels

void main() {
  // Textures are sampled before any discard, after which the derivatives that select the mip level are undefined.
  VoxelFragment fragment = sampleView();
#if !FIRST
  if (gl_FragCoord.z <= texelFetch(layerBefore, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
  if (fragment.albedoBCoverage >> 16 == 0u) discard;
  surface = uvec4(fragment.normal, fragment.albedoRg, fragment.albedoBCoverage, fragment.emission);
  depthInGrid = posView.z;
}
