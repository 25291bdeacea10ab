#version 450
// Writes the nodes: thesis 004, Sec. 4.2.2, Listing 4.22.
// Deviates: a tile's place is the number of tiles before it along the curve of the tags, in place of what an atomic counter happens to hold:
// the same tree at every run, and all depths at once.
#define OCTREE_BUILD
#include "octree_tags.glsl"
layout(local_size_x = 64) in;
#include "octree_levels.glsl"

layout(std140, binding = 0) uniform NodeRoom {
  uint roomBricks, roomTiles;
  uint words;
};
layout(std430, binding = 5) readonly buffer TilesBefore { uint tilesBefore[]; };
layout(std430, binding = 12) readonly buffer OctreeRanks { RankedTags octreeRanks[]; };

// The first of the eight nodes behind byte `tile` of a depth.
uint nodesOf(uint tile, int depth) {
  uint word = firstWord(depth) + (tile >> 2), tiles = tilesIn(octreeRanks[word].tags), place = 8u * (tile & 3u);
  if ((tiles >> place & 1u) == 0u) return kNone;
  return 8u * (tilesBefore[word] + uint(bitCount(below(tiles, place))));
}

void main() {
  uint word = listIndex();
  if (word >= words || wantedBricks > roomBricks || wantedTiles > roomTiles) return;
  uint bits = octreeRanks[word].tags;
  if (bits == 0u) return;
  int depth = 0;
  while (depth < octreeDepth && firstWord(depth + 1) <= word) ++depth;
  for (uint byte = 0u; byte < 4u; ++byte) {
    if ((bits >> 8u * byte & 255u) == 0u) continue;
    uint tile = 4u * (word - firstWord(depth)) + byte, first = nodesOf(tile, depth);
    for (uint child = 0u; child < 8u; ++child) {
      uint bit = 8u * byte + child;
      if ((bits >> bit & 1u) == 0u) continue;  // the pool was emptied
      uint morton = 8u * tile + child, brick = octreeRanks[word].nodesBefore + uint(bitCount(below(bits, bit)));
      octreeNodes[first + child].brick = brick;
      octreeNodes[first + child].children = depth < octreeDepth ? nodesOf(morton, depth + 1) : kNone;
      octreeBricks[brick] = OctreeBrick(first + child, packVoxel(placeOf(morton)));
    }
  }
}
