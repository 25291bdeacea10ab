#version 450
// Stacks of 128 voxels in the four words of a texel (Thiedemann et al. 2011; thesis 004 Sec. 3.2.1).
// Deviates: bit 0 of the first component is the nearest voxel, where the thesis counts from the highest bit.
// TOUCHED: only columns with moving geometry in this frame or the last; the others are unchanged.
#pragma lumivox axis TOUCHED 0 1
#include "bits.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 2, rgba32ui) uniform writeonly uimage2DArray stacks;
#if TOUCHED
layout(binding = 3, r32ui) uniform readonly uimage2D touched;
#endif

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, imageSize(stacks)))) return;
#if TOUCHED
  if (imageLoad(touched, texel.xy).r == 0u) return;
#endif
  uvec4 stack;
  for (int c = 0; c < 4; ++c) stack[c] = wordAt(ivec3(texel.xy, 4 * texel.z + c));
  imageStore(stacks, texel, stack);
}
