// Writes voxels of a clipmap.
#include "clipmap.glsl"

// A bit for each voxel that is not empty.
layout(std430, binding = 13) buffer ClipmapOccupied { uint clipmapOccupied[]; };
// Of whatever float format the volumes have; by the outward normals of the faces.
layout(binding = 0) uniform writeonly image3D positiveXImage;
layout(binding = 1) uniform writeonly image3D negativeXImage;
layout(binding = 2) uniform writeonly image3D positiveYImage;
layout(binding = 3) uniform writeonly image3D negativeYImage;
layout(binding = 4) uniform writeonly image3D positiveZImage;
layout(binding = 5) uniform writeonly image3D negativeZImage;

bool isOccupied(ClipmapPlace place) { return (clipmapOccupied[place.word] & place.bit) != 0u; }

void writeTexel(ivec3 texel, vec4 faces[6]) {
  imageStore(positiveXImage, texel, faces[0]);
  imageStore(negativeXImage, texel, faces[1]);
  imageStore(positiveYImage, texel, faces[2]);
  imageStore(negativeYImage, texel, faces[3]);
  imageStore(positiveZImage, texel, faces[4]);
  imageStore(negativeZImage, texel, faces[5]);
}

// The voxel, and its copies beyond the other ends of its block.
void writeVoxel(ClipmapPlace place, vec4 faces[6], bool occupied) {
  ivec3 below = -ivec3(equal(place.address, ivec3(place.period - 1))), above = ivec3(equal(place.address, ivec3(0)));
  for (int z = below.z; z <= above.z; ++z)
    for (int y = below.y; y <= above.y; ++y)
      for (int x = below.x; x <= above.x; ++x) writeTexel(place.texel + place.period * ivec3(x, y, z), faces);
  if (occupied)
    atomicOr(clipmapOccupied[place.word], place.bit);
  else
    atomicAnd(clipmapOccupied[place.word], ~place.bit);
}
