// Sums of the texels' luminances of flux as a tree: each sum is of 16 neighbours in the order layer, row, column, or of 16 such sums. The
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

// Layers are square.
ivec3 texelOf(uint index, uint width) { return ivec3(index % width, index / width % width, index / width / width); }

// The one after it.
void advance(inout ivec3 texel, uint width) {
  if (++texel.x < int(width)) return;
  texel.x = 0;
  if (++texel.y < int(width)) return;
  texel.y = 0;
  ++texel.z;
}

#endif
