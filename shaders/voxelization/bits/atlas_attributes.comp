#version 450
// Multi-valued voxels from the atlas (Thiedemann et al. 2011): each texel appends a fragment with the attributes at its place.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
layout(local_size_x = 64) in;
#include "../surface_point.glsl"
#include "atlas.glsl"

void main() {
  int texel = texelOfThread();
  if (texel < 0) return;
  SurfacePlace place = placeOf(texel);
  appendPoint(place.triangle, place.corners, place.weights);
}
