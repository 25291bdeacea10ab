// The part of a light that falls into a texel of its view.
#ifndef LUMIVOX_CROSS_SECTION
#define LUMIVOX_CROSS_SECTION
#include "common/lights.glsl"

// Cross-section, m^2, at posWorld of the light through a texel, `fromMiddle` texels from the middle of the view. In perspective, a texel of
// width w at (u, v) on the plane at distance 1 has the solid angle w^2 / (1 + u^2 + v^2)^(3/2).
float crossSectionOf(LightSample light, vec3 posWorld, vec2 fromMiddle) {
  float crossSection = light.texelWidth * light.texelWidth;
  if (light.kind != kLightDirectional) {
    vec2 onPlane = fromMiddle * light.texelWidth;
    float secantSquared = 1.0 + dot(onPlane, onPlane);
    vec3 path = light.position - posWorld;
    crossSection *= dot(path, path) / (secantSquared * sqrt(secantSquared));
  }
  return crossSection;
}

#endif
