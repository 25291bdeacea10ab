#version 450
// Binary voxels from the atlas (Thiedemann et al. 2011; thesis 004 Sec. 4.4.4): each texel sets the bit of the voxel that it lies in.
// Deviates: an atomic operation on words instead of a logical operation of the frame buffer, which would need more render targets the
// deeper the grid is.
#pragma lumivox axis MASKS 0 1
#define TEXTURES 0
#define SCENE_GEOMETRY
layout(local_size_x = 64) in;
#include "common/scene.glsl"

layout(std140, binding = 1) uniform Point { float pointSize; };  // voxels
#include "../list_grid.glsl"
layout(binding = 0, r32ui) uniform uimage3D words;
#include "../grid_corner.glsl"
#include "../surface_texture.glsl"
#include "atlas.glsl"

void main() {
  int texel = texelOfThread();
  if (texel < 0) return;
  SurfacePlace place = placeOf(texel);
  vec3 posGrid = place.corners[0] * place.weights.x + place.corners[1] * place.weights.y + place.corners[2] * place.weights.z;
  int depth = int(floor(posGrid.z));
  if (depth < 0 || depth >= resolution.z) return;
  // Thesis 004 Sec. 4.4.3: a larger point closes the holes of an atlas with too few texels. The point is a square in x and y and covers the
  // columns (i, j) whose centres lie in it, |i + 1/2 - x| <= pointSize / 2; along z it stays one voxel.
  float reach = 0.5 * (pointSize - 1.0);
  ivec2 low = max(ivec2(floor(posGrid.xy - reach)), ivec2(0)), high = min(ivec2(floor(posGrid.xy + reach)), resolution.xy - 1);
  if (any(greaterThan(low, high))) return;
#if MASKS
  if (surfaceTextureAt(place.triangle, place.corners, place.weights).coverage <= 0.0) return;
#endif
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) imageAtomicOr(words, ivec3(x, y, depth >> 5), 1u << (depth & 31));
}
