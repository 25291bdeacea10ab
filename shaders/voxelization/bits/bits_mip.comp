#version 450
// A coarser level of the stacks: the union of 2x2 stacks, and of the third row or column at an odd end (thesis 004 Sec. 4.4.5). The
// resolution along z stays the same.
// TOUCHED: only texels above columns with moving geometry in this frame or the last.
#pragma lumivox axis TOUCHED 0 1
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32ui) uniform readonly uimage2DArray finer;
layout(binding = 1, rgba32ui) uniform writeonly uimage2DArray coarser;
#if TOUCHED
layout(binding = 2, r32ui) uniform readonly uimage2D touchedFiner;
layout(binding = 3, r32ui) uniform writeonly uimage2D touchedCoarser;
#endif

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID), size = imageSize(coarser);
  if (any(greaterThanEqual(texel, size))) return;
  ivec2 finerSize = imageSize(finer).xy;
  ivec2 low = 2 * texel.xy;
  ivec2 high = min(low + 1, finerSize - 1);
  if (texel.x == size.x - 1) high.x = finerSize.x - 1;
  if (texel.y == size.y - 1) high.y = finerSize.y - 1;
#if TOUCHED
  uint touched = 0u;
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) touched |= imageLoad(touchedFiner, ivec2(x, y)).r;
  if (texel.z == 0) imageStore(touchedCoarser, texel.xy, uvec4(touched));
  if (touched == 0u) return;
#endif
  uvec4 stack = uvec4(0u);
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) stack |= imageLoad(finer, ivec3(x, y, texel.z));
  imageStore(coarser, texel, stack);
}
