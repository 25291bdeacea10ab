// Images of samples that lie `every` pixels apart: a texel belongs to the pixel in the middle of its block.
#ifndef LUMIVOX_SAMPLED_PIXELS
#define LUMIVOX_SAMPLED_PIXELS

ivec2 sampledPixel(ivec2 texel, ivec2 every, ivec2 imageSize) { return min(every * texel + every / 2, imageSize - 1); }

#endif
