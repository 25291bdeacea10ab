#version 450
// Writes the bricks' places and the nodes (thesis 004, Sec. 4.2.2, Listing 4.22), or the bricks around those that are shown.
// Deviates: a tile's place is the number of tiles before it along the curve of the tags, in place of what an atomic counter happens to hold:
// the same tree at every run, and all depths at once.
#pragma lumivox axis BRICKS own published
#define OCTREE_BUILD
#include "toolkit/bit_tree.glsl"
layout(local_size_x = 64) in;
#include "octree_levels.glsl"
#include "octree_ranks.glsl"

layout(std140, binding = 0) uniform NodeRoom {
  uint roomBricks, roomTiles;
  uint words;
};

#if BRICKS == BRICKS_OWN
#include "octree_corners.glsl"

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

void writeNode(uint morton, int depth, uint brick) { octreeBricks[brick] = OctreeBrick(kNone, packVoxel(placeOf(morton))); }
#else
layout(std430, binding = 5) readonly buffer Records { RankedTags records[]; };  // tiles

// The first of the eight nodes behind byte `tile` of a depth.
uint nodesOf(uint tile, int depth) {
  uint word = firstWord(depth) + (tile >> 2), place = 8u * (tile & 3u);
  RankedTags tiles = records[word];
  if ((tiles.tags >> place & 1u) == 0u) return kNone;
  return 8u * (tiles.nodesBefore + uint(bitCount(below(tiles.tags, place))));
}

void writeNode(uint morton, int depth, uint brick) {
  uint node = nodesOf(morton >> 3, depth) + (morton & 7u);
  octreeNodes[node].brick = brick;
  octreeNodes[node].children = depth < octreeDepth ? nodesOf(morton, depth + 1) : kNone;
  octreeBricks[brick] = OctreeBrick(node, packVoxel(placeOf(morton)));
}
#endif

void main() {
  uint word = listIndex();
  if (word >= words || wantedBricks > roomBricks || wantedTiles > roomTiles) return;
  int depth = 0;
  while (depth < octreeDepth && firstWord(depth + 1) <= word) ++depth;
#if BRICKS == BRICKS_OWN
  writeCorners(word, depth);
#endif
  uint bits = octreeRanks[word].tags, brick = octreeRanks[word].nodesBefore;
  for (; bits != 0u; bits &= bits - 1u) writeNode(32u * (word - firstWord(depth)) + uint(findLSB(bits)), depth, brick++);
}
