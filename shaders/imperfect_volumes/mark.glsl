// Marks the voxels that a surface point reads.
#include "neighbours.glsl"
layout(binding = 0, r32ui) uniform writeonly uimage3D marks;

void markReads(vec3 surface, vec3 normal) {
  for (int i = 0; i < neighbourCount(); ++i) {
    vec3 place;
    if (neighbour(i, surface, normal, place) <= 0.0) continue;
    ivec3 low = ivec3(floor(isFiltered() ? place - 0.5 : place));
    for (int corner = 0; corner < (isFiltered() ? 8 : 1); ++corner)
      imageStore(marks, inVolume(low + ivec3(corner & 1, corner >> 1 & 1, corner >> 2)), uvec4(1u));
  }
}
