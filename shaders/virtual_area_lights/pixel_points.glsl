// Points at every stride-th pixel of a view. C++ side: techniques/virtual_area_lights/pixels.cpp.
#ifndef LUMIVOX_PIXEL_POINTS
#define LUMIVOX_PIXEL_POINTS
#include "point_texel.glsl"

layout(std140, binding = 1) uniform PixelPoints {
  ivec2 pixelPoints;  // along x and y
  int stride;         // pixels
};

// The middle of a point's square of pixels.
ivec2 pixelOfPoint(ivec2 point, ivec2 size) { return min(point * stride + stride / 2, size - 1); }

#endif
