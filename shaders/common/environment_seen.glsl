// The environment as camera rays see it: the texel of the map, as the reference reads it (lumivox/scene/environment.h has the convention).
#ifndef LUMIVOX_ENVIRONMENT_SEEN
#define LUMIVOX_ENVIRONMENT_SEEN
#include "common/constants.glsl"
#include "common/environment_view.glsl"
layout(constant_id = 20) const int environmentMap = 0;  // 1: the environment differs by direction; 0: nothing is read
layout(binding = 12) uniform sampler2D environmentTexels;

vec3 environmentSeen(vec3 constant, ivec2 pixel) {
  if (environmentMap == 0 || constant == vec3(0.0)) return constant;
  vec3 direction = directionOfPixel(pixel);
  direction = direction.x * toMapX.xyz + direction.y * toMapY.xyz + direction.z * toMapZ.xyz;
  vec2 place = vec2(0.5 + atan(direction.x, -direction.z) / (2.0 * kPi), atan(length(direction.xz), direction.y) / kPi);
  ivec2 size = textureSize(environmentTexels, 0);
  return texelFetch(environmentTexels, clamp(ivec2(place * vec2(size)), ivec2(0), size - 1), 0).rgb;
}
#endif
