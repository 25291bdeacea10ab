// The neighbours of a node at higher x, y and z. Included after octree.glsl.
#ifndef LUMIVOX_OCTREE_NEIGHBOURS
#define LUMIVOX_OCTREE_NEIGHBOURS

uint neighbour(ivec3 place, int depth) {
  if (any(greaterThanEqual(place, ivec3(1 << depth)))) return kNone;
  uint node = nodeAt(place, depth);
  return node != kNone && octreeNodes[node].brick != kNone ? node : kNone;
}

void findNeighbours(uint node, ivec3 place, int depth) {
  octreeNodes[node].neighbourX = neighbour(place + ivec3(1, 0, 0), depth);
  octreeNodes[node].neighbourY = neighbour(place + ivec3(0, 1, 0), depth);
  octreeNodes[node].neighbourZ = neighbour(place + ivec3(0, 0, 1), depth);
}

#endif
