// The volume: voxels (i, j, k), lengths in voxels from the corner of voxel (0, 0, 0).
// C++ side: techniques/imperfect_volumes/volume.h.
#ifndef LUMIVOX_VOLUME
#define LUMIVOX_VOLUME

layout(std140, binding = 1) uniform Volume {
  vec3 gridLow;      // m
  float voxelSize;   // m
  ivec3 resolution;
  float occupied;    // coverage above which a voxel is occupied
};

ivec3 inVolume(ivec3 voxel) { return clamp(voxel, ivec3(0), resolution - 1); }
bool isInVolume(vec3 place) { return all(greaterThanEqual(place, vec3(0.0))) && all(lessThan(place, vec3(resolution))); }
ivec3 voxelOfNumber(uint number) {
  uint width = uint(resolution.x), height = uint(resolution.y);
  return ivec3(number % width, number / width % height, number / width / height);
}
uint voxelCount() { return uint(resolution.x) * uint(resolution.y) * uint(resolution.z); }

#endif
