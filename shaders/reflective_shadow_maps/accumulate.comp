#version 450
// A level of the tree of sums from the level below it. No sum has more than 16 addends, so that rounding loses little of dim lights beside
// bright ones, and all sums of a level are computed in parallel.
#pragma lumivox axis OF texels sums
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "sum_tree.glsl"

layout(std140, binding = 0) uniform Parameters {
  uint addends;
  uint firstAddend;   // in the tree
  uint firstSum;
  uint width, height, rows, together, ways;  // TexelOrder
};
#if OF == OF_TEXELS
layout(binding = 0) uniform sampler2DArray rsmFlux;
#endif
layout(std430, binding = 0) buffer Tree { float sums[]; };

void main() {
  uint index = listIndex(), first = index * kFan;
  if (first >= addends) return;
  float sum = 0.0;
#if OF == OF_TEXELS
  TexelOrder order = TexelOrder(width, height, rows, together, ways);
  ivec3 texel = texelOf(first, order);
#endif
  for (uint i = first; i < min(first + kFan, addends); ++i) {
#if OF == OF_TEXELS
    sum += luminance(texelFetch(rsmFlux, texel, 0).rgb);
    advance(texel, order);
#else
    sum += sums[firstAddend + i];
#endif
  }
  sums[firstSum + index] = sum;
}
