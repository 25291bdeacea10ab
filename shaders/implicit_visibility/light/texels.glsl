// The texel of a numbered value. Ports SurfaceElements and ElementLight.
#ifndef LUMIVOX_TEXELS
#define LUMIVOX_TEXELS

const uint kWidth = 1024u;  // texels in a row

ivec2 texelOf(uint number) { return ivec2(number % kWidth, number / kWidth); }
#endif
