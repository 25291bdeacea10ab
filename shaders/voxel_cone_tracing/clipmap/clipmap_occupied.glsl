// One bit per voxel of a clipmap, set if the voxel is not empty.
#ifndef LUMIVOX_CLIPMAP_OCCUPIED
#define LUMIVOX_CLIPMAP_OCCUPIED
#ifndef OCCUPIED_ACCESS
#define OCCUPIED_ACCESS readonly
#endif
layout(std430, binding = 13) OCCUPIED_ACCESS buffer ClipmapOccupied { uint clipmapOccupied[]; };

bool isOccupied(ClipmapPlace place) { return (clipmapOccupied[place.word] & place.bit) != 0u; }

#endif
