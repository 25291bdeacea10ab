#version 450
// Binary voxels from the atlas (Thiedemann et al. 2011; thesis 004 Sec. 4.4.4): each texel sets the bit of the voxel that it lies in.
// Deviates: an atomic operation on words in place of a logical operation of the frame buffer, for which grids of any depth would need as
// many targets.
#pragma lumivox axis MASKS 0 1
#define TEXTURES 0
#define SCENE_GEOMETRY
layout(local_size_x = 64) in;
#include "common/scene.glsl"

layout(std140, binding = 1) uniform Grid {
  vec3 gridLow;     // m
  float voxelSize;  // m
  ivec3 resolution;
};
layout(binding = 0, r32ui) uniform uimage3D words;
#include "grid_corner.glsl"
#include "surface_texture.glsl"
#include "atlas.glsl"

void main() {
  int texel = texelOfThread();
  if (texel < 0) return;
  SurfacePlace place = placeOf(texel);
  ivec3 voxel = ivec3(floor(place.corners[0] * place.weights.x + place.corners[1] * place.weights.y + place.corners[2] * place.weights.z));
  if (any(lessThan(voxel, ivec3(0))) || any(greaterThanEqual(voxel, resolution))) return;
#if MASKS
  if (surfaceTextureAt(place.triangle, place.corners, place.weights).coverage <= 0.0) return;
#endif
  imageAtomicOr(words, ivec3(voxel.xy, voxel.z >> 5), 1u << (voxel.z & 31));
}
