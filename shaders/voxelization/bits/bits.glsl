// One bit per voxel in 32-bit words along z: bit b of texel (i, j, w) is voxel (i, j, 32 w + b).
#pragma lumivox axis SURFACE 0 1
layout(binding = 0, r32ui) uniform readonly uimage3D words;  // the voxelized bits
#if SURFACE
layout(binding = 1, r32ui) uniform readonly uimage3D surfaceWords;  // voxels of the given surface samples
#endif

uint surfaceWordAt(ivec3 place) {
#if SURFACE
  return imageLoad(surfaceWords, place).r;
#else
  return 0u;
#endif
}

// The 32 voxels of a word in either image; 0 outside the grid.
uint wordAt(ivec3 place) {
  if (place.z >= imageSize(words).z) return 0u;
  return imageLoad(words, place).r | surfaceWordAt(place);
}
