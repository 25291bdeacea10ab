#version 450
// Depth peeling (Everitt 2001) as Li et al. 2005 use it: what lies no deeper than the layer before is peeled off, and the depth test finds
// the nearest of the rest. A pixel keeps what its fragment will need.
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
  // Textures are sampled before anything is thrown away: the derivatives that choose their mip are undefined behind a discard.
  VoxelFragment fragment = sampleView();
#if !FIRST
  if (gl_FragCoord.z <= texelFetch(layerBefore, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
  if (fragment.albedoBCoverage >> 16 == 0u) discard;
  surface = uvec4(fragment.normal, fragment.albedoRg, fragment.albedoBCoverage, fragment.emission);
  depthInGrid = posView.z;
}
