#version 450
// Writes the positions of the bricks, and the bricks around the shown nodes, for all depths at once. The tree is the same at every run.
// (Thesis 004, Sec. 4.2.2, Listing 4.22 allocates nodes by atomic counters, depth after depth.)
#define OCTREE_BUILD
#include "toolkit/bit_tree.glsl"
layout(local_size_x = 64) in;
#include "octree_levels.glsl"
#include "octree_ranks.glsl"
#include "octree_corners.glsl"

layout(std140, binding = 0) uniform NodeRoom {
  uint roomBricks, roomShown;
  uint words;
};

void writeCorners(uint word, int depth) {
  uint bits = octreeShown[word].tags, record = octreeShown[word].nodesBefore;
  for (; bits != 0u; bits &= bits - 1u) {
    ivec3 place = placeOf(32u * (word - firstWord(depth)) + uint(findLSB(bits)));
    for (int corner = 0; corner < 8; ++corner) {
      ivec3 around = place + ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
      bool inside = all(lessThan(around, ivec3(1 << depth)));
      octreeCorners[8u * record + uint(corner)] = inside ? rankedBrick(mortonOf(around), depth) : kNone;
    }
    ++record;
  }
}

void main() {
  uint word = listIndex();
  if (word >= words || wantedBricks > roomBricks || wantedShown > roomShown) return;
  int depth = 0;
  while (depth < octreeDepth && firstWord(depth + 1) <= word) ++depth;
  writeCorners(word, depth);
  uint bits = octreeRanks[word].tags, brick = octreeRanks[word].nodesBefore;
  for (; bits != 0u; bits &= bits - 1u) octreeBricks[brick++] = packVoxel(placeOf(32u * (word - firstWord(depth)) + uint(findLSB(bits))));
}
