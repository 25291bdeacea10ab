// Directions of camera rays towards the environment. C++ side: EnvironmentViewBinding in lumivox/toolkit/environment.h.
#ifndef LUMIVOX_ENVIRONMENT_VIEW
#define LUMIVOX_ENVIRONMENT_VIEW
layout(std140, binding = 9) uniform EnvironmentView {
  vec4 viewCorner;     // direction through the upper left corner of the image
  vec4 viewPerColumn;  // its change from pixel to pixel
  vec4 viewPerRow;
  vec4 toMapX, toMapY, toMapZ;  // columns of the rotation from the world to the map
};

// Through the middle of a pixel, not normalised.
vec3 directionOfPixel(ivec2 pixel) {
  return viewCorner.xyz + (float(pixel.x) + 0.5) * viewPerColumn.xyz + (float(pixel.y) + 0.5) * viewPerRow.xyz;
}
#endif
