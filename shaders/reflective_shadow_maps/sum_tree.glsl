// Sums of the texels' luminances of flux as a tree: each sum is of 16 neighbours in the order of texels, or of 16 such sums. The
// root is the first, then follow the levels down to the texels. C++ side: techniques/reflective_shadow_maps/choose.cpp.
#ifndef LUMIVOX_SUM_TREE
#define LUMIVOX_SUM_TREE
#include "common/rsm.glsl"

const uint kFan = 16u;

// Sums of a level; level 0 are the texels themselves.
uint levelSize(uint texels, uint level) {
  uint size = texels;
  for (uint i = 0u; i < level; ++i) size = (size + kFan - 1u) / kFan;
  return size;
}

// In which order the texels of a map are numbered. Layers are cut into strips, which are passed column by column; at each place
// the layers of `together` views are passed, which look the same way. Rows one high of layers on their own are the order of the texture.
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

// The one after it.
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
