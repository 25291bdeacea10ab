// One bit per voxel in 32-bit words along z: bit b of texel (i, j, w) is voxel (i, j, 32 w + b).
#pragma lumivox axis SURFACE 0 1
layout(binding = 0, r32ui) uniform readonly uimage3D words;  // what was voxelized
#if SURFACE
layout(binding = 1, r32ui) uniform readonly uimage3D surfaceWords;  // voxels of surface samples that were given
#endif

uint surfaceWordAt(ivec3 place) {
#if SURFACE
  return imageLoad(surfaceWords, place).r;
#else
  return 0u;
#endif
}

// The 32 voxels of both in one word; none outside the grid.
uint wordAt(ivec3 place) {
  if (place.z >= imageSize(words).z) return 0u;
  return imageLoad(words, place).r | surfaceWordAt(place);
}
