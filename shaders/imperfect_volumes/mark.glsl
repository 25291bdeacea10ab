// Marks the voxels that a surface point reads.
#include "neighbours.glsl"
#include "turns.glsl"
layout(binding = 0, r32ui) uniform writeonly uimage3D marks;

// The lowest of the eight voxels from which neighbour i is filtered, or its only voxel; false if its weight is 0.
bool readBlock(int i, vec3 surface, vec3 normal, out ivec3 low) {
  vec3 place;
  bool counts = neighbour(i, surface, normal, place) > 0.0;
  low = ivec3(floor(isFiltered() ? place - 0.5 : place));
  return counts;
}

void markBlock(ivec3 low) {
  for (int corner = 0; corner < (isFiltered() ? 8 : 1); ++corner)
    imageStore(marks, inVolume(low + ivec3(corner & 1, corner >> 1 & 1, corner >> 2)), uvec4(kSeen));
}

void markReads(vec3 surface, vec3 normal) {
  for (int i = 0; i < neighbourCount(); ++i) {
    ivec3 low;
    if (readBlock(i, surface, normal, low)) markBlock(low);
  }
}
