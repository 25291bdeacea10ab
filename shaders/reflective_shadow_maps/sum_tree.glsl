// A tree of sums of the luminances of the texels' flux: each sum is over 16 neighbours in the order of the texels, or over 16 such sums.
// The root comes first, then the levels down to the texels. C++ side: techniques/reflective_shadow_maps/choose.cpp.
#ifndef LUMIVOX_SUM_TREE
#define LUMIVOX_SUM_TREE
#include "common/rsm.glsl"

const uint kFan = 16u;

// Number of sums of a level; level 0 is the texels themselves.
uint levelSize(uint texels, uint level) {
  uint size = texels;
  for (uint i = 0u; i < level; ++i) size = (size + kFan - 1u) / kFan;
  return size;
}

// The order of a map's texels. Layers are cut into strips of `rows` rows, which are traversed column by column. At each position, the layers
// of `together` views with the same direction follow each other. With rows = 1 and together = 1, it is the order of the texture.
struct TexelOrder {
  uint width, height;  // texels of a layer
  uint rows;      // of a strip
  uint together;
  uint ways;      // layers / together
};

uint rowsAt(uint row, TexelOrder order) { return min(order.rows, order.height - row / order.rows * order.rows); }

ivec3 texelOf(uint index, TexelOrder order) {
  uint place = index / order.together, inLayer = place % (order.width * order.height);
  uint row = inLayer / (order.width * order.rows) * order.rows, rows = rowsAt(row, order), inStrip = inLayer % (order.width * order.rows);
  uint way = place / (order.width * order.height);
  return ivec3(inStrip / rows, row + inStrip % rows, index % order.together * order.ways + way);
}

// The next texel in the order.
void advance(inout ivec3 texel, TexelOrder order) {
  texel.z += int(order.ways);
  if (texel.z < int(order.together * order.ways)) return;
  texel.z %= int(order.ways);
  int first = texel.y / int(order.rows) * int(order.rows), rows = int(rowsAt(uint(texel.y), order));
  if (++texel.y < first + rows) return;
  texel.y = first;
  if (++texel.x < int(order.width)) return;
  texel.x = 0;
  texel.y += rows;
  if (texel.y < int(order.height)) return;
  texel.y = 0;
  ++texel.z;
}

#endif
