// Writes voxels of a clipmap.
#include "clipmap.glsl"

#define OCCUPIED_ACCESS
#include "clipmap_occupied.glsl"
#include "../face_images.glsl"

// Writes a voxel, and its copies in the border at the opposite sides of its block.
void writeVoxel(ClipmapPlace place, vec4 faces[6], bool occupied) {
  ivec3 below = -ivec3(equal(place.address, ivec3(place.period - 1))), above = ivec3(equal(place.address, ivec3(0)));
  for (int z = below.z; z <= above.z; ++z)
    for (int y = below.y; y <= above.y; ++y)
      for (int x = below.x; x <= above.x; ++x) storeFaces(place.texel + place.period * ivec3(x, y, z), faces);
  if (occupied)
    atomicOr(clipmapOccupied[place.word], place.bit);
  else
    atomicAnd(clipmapOccupied[place.word], ~place.bit);
}
